/* A function that CasADi wrote as C, in a loop over configurations: GENERATED is its file, FUNCTION and WORK its names. */
#include <stdlib.h>
#include GENERATED

void loop(long count, long inputs, const long *widths, const double **input, long width, double *out) {
    casadi_int arguments, results, integers, doubles;
    WORK(&arguments, &results, &integers, &doubles);
    const double **argument = malloc(sizeof(double *) * (size_t)(arguments + inputs + 1));
    double **result = malloc(sizeof(double *) * (size_t)(results + 1));
    casadi_int *integer = malloc(sizeof(casadi_int) * (size_t)(integers + 1));
    double *memory = malloc(sizeof(double) * (size_t)(doubles + 1));
    for (long k = 0; k < count; ++k) {
        for (long i = 0; i < inputs; ++i) argument[i] = input[i] + k * widths[i];
        result[0] = out + k * width;
        FUNCTION(argument, result, integer, memory, 0);
    }
    free(argument), free(result), free(integer), free(memory);
}
