/* Nanoseconds per pair of sine and cosine of a generated model.c, from angles to results in the cache. */
#define _POSIX_C_SOURCE 199309L
#include <time.h>
#include MODEL

enum { BLOCKS = 64 };

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

double pairs(long turns) {
    static double x[BLOCKS * LANES], s[BLOCKS * LANES], c[BLOCKS * LANES];
    for (int i = 0; i < BLOCKS * LANES; ++i) x[i] = 0.01 * i - 2;
    const double start = now();
    for (long k = 0; k < turns; ++k) {
        sines_cosines(BLOCKS, x, s, c);
        __asm__ volatile("" : : "r"(s), "r"(c) : "memory");
    }
    return (now() - start) / (BLOCKS * LANES * (double)turns);
}
