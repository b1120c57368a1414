/* What one core of this machine can do: unfused multiplications and additions, sines and cosines, memory traffic.
 *
 * Each function returns nanoseconds: per operation, per pair of sine and cosine, per byte moved. LANES doubles fit in a
 * vector. The vectorised sine and cosine are glibc's libmvec, called apart since GCC would merge the two into one call
 * that libmvec lacks; without VECTOR_SIN they are left out.
 */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdlib.h>
#include <time.h>

typedef double vector __attribute__((vector_size(8 * LANES)));

#ifdef VECTOR_SIN
vector VECTOR_SIN(vector);
vector VECTOR_COS(vector);
#endif

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* The compiler may neither fold nor drop the value. */
#define KEEP(v) __asm__ volatile("" : "+v"(v))

double arithmetic(long turns) {
    vector factor = {0}, term = {0};
    factor += 0.999999, term += 1e-9;
    vector a = factor, b = factor, c = factor, d = factor, e = factor, f = factor;
    vector s = term, t = term, u = term, v = term, w = term, x = term;
    KEEP(factor); KEEP(term);
    const double start = now();
    for (long i = 0; i < turns; ++i) {
        a *= factor, b *= factor, c *= factor, d *= factor, e *= factor, f *= factor;
        s += term, t += term, u += term, v += term, w += term, x += term;
        KEEP(a); KEEP(b); KEEP(c); KEEP(d); KEEP(e); KEEP(f); KEEP(s); KEEP(t); KEEP(u); KEEP(v); KEEP(w); KEEP(x);
    }
    return (now() - start) / (12.0 * LANES * (double)turns);
}

double scalar_pairs(long turns) {
    double sum = 0, x = 0.1;
    const double start = now();
    for (long i = 0; i < turns; ++i) sum += sin(x) + cos(x), x += 1e-4;
    __asm__ volatile("" : : "x"(sum));
    return (now() - start) / (double)turns;
}

double vector_pairs(long turns) {
#ifdef VECTOR_SIN
    vector sum = {0}, x = {0};
    const double start = now();
    for (long i = 0; i < turns; ++i) {
        vector y = x;
        KEEP(y);
        sum += VECTOR_SIN(x) + VECTOR_COS(y);
        x += 1e-4;
    }
    KEEP(sum);
    return (now() - start) / (LANES * (double)turns);
#else
    (void)turns;
    return 0;
#endif
}

/* a = b + k c on arrays larger than the caches: two are read, and the third is read and written back. */
double memory(long size) {
    double *a = malloc(8 * (size_t)size), *b = malloc(8 * (size_t)size), *c = malloc(8 * (size_t)size);
    double best = 1e300;
    if (!a || !b || !c) return 0;
    for (long i = 0; i < size; ++i) a[i] = 0, b[i] = 1, c[i] = 2;
    for (int turn = 0; turn < 7; ++turn) {
        const double start = now();
        for (long i = 0; i < size; ++i) a[i] = b[i] + 1.5 * c[i];
        __asm__ volatile("" : : "r"(a) : "memory");
        const double spent = now() - start;
        best = spent < best ? spent : best;
    }
    free(a), free(b), free(c);
    return best / (32.0 * (double)size);
}
