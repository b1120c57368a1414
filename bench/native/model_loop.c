/* A function of a generated model.c in a loop over configurations: MODEL is the file, CALL the call for number k. */
#include MODEL

void loop(long count, const double *q, const double *qd, const double *qdd, double *out) {
    (void)qd, (void)qdd;
    for (long k = 0; k < count; ++k) CALL;
}
