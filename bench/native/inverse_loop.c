/* Inverse kinematics pose by pose: SOURCE is the file, CALL the call for pose number k, whose results go to `out`. */
#include SOURCE

void loop(long count, const double *T, double *out, int *found) {
    (void)found;
    for (long k = 0; k < count; ++k) CALL;
}
