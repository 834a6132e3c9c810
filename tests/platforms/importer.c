/*
 * Runs a component for 60 s with steps of 10 ms and writes the watched variables at each second to the standard output,
 * as the 16 hexadecimal digits of their bits, so that runs on different machines can be compared exactly.
 *
 *   importer 2|3 LIBRARY TOKEN RESOURCES INPUTS WATCHED
 *
 * INPUTS is reference=value,… and WATCHED reference,…
 */
#include <inttypes.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
static void *open_library(const char *path) { return (void *)LoadLibraryA(path); }
static void *find(void *library, const char *name) { return (void *)GetProcAddress((HMODULE)library, name); }
#else
#include <dlfcn.h>
static void *open_library(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *find(void *library, const char *name) { return dlsym(library, name); }
#endif

enum { MOST = 32 };

static void fail(const char *what)
{
    fprintf(stderr, "importer: %s\n", what);
    exit(1);
}

static void *needed(void *library, const char *name)
{
    void *function = find(library, name);
    if (function == NULL)
        fail(name);
    return function;
}

static void log2(void *environment, const char *instance, int status, const char *category, const char *message, ...)
{
    va_list arguments;
    (void)environment;
    va_start(arguments, message);
    fprintf(stderr, "%s %d %s: ", instance, status, category);
    vfprintf(stderr, message, arguments);
    fputc('\n', stderr);
    va_end(arguments);
}

static void log3(void *environment, int status, const char *category, const char *message)
{
    (void)environment;
    fprintf(stderr, "%d %s: %s\n", status, category, message);
}

struct callbacks2 {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *step_finished;
    void *environment;
};

static const struct callbacks2 callbacks = {log2, calloc, free, NULL, NULL};

static void check(int status, const char *call)
{
    if (status != 0)
        fail(call);
}

static void write_values(const double *values, size_t count)
{
    for (size_t k = 0; k < count; k++) {
        uint64_t bits;
        memcpy(&bits, &values[k], sizeof bits);
        printf("%016" PRIx64 "%c", bits, k + 1 < count ? ' ' : '\n');
    }
}

/* "3=1.5,4=2" into references and values; values may be missing. */
static size_t parse(char *text, unsigned *references, double *values)
{
    size_t count = 0;
    for (char *part = strtok(text, ","); part != NULL && count < MOST; part = strtok(NULL, ","), count++) {
        char *rest;
        references[count] = (unsigned)strtoul(part, &rest, 10);
        values[count] = *rest == '=' ? strtod(rest + 1, NULL) : 0.0;
    }
    return count;
}

int main(int argc, char **argv)
{
    unsigned inputs[MOST], watched[MOST];
    double given[MOST], values[MOST], unused[MOST];
    if (argc != 7)
        fail("usage: importer 2|3 LIBRARY TOKEN RESOURCES INPUTS WATCHED");
    bool third = argv[1][0] == '3';
    const char *token = argv[3], *resources = argv[4];
    size_t given_count = parse(argv[5], inputs, given), watched_count = parse(argv[6], watched, unused);
    void *library = open_library(argv[2]);
    if (library == NULL)
        fail("the library cannot be loaded");

    void *instance;
    int (*set)(void *, const unsigned *, size_t, const double *, size_t) = NULL;
    int (*get)(void *, const unsigned *, size_t, double *, size_t) = NULL;
    int (*set2)(void *, const unsigned *, size_t, const double *) = NULL;
    int (*get2)(void *, const unsigned *, size_t, double *) = NULL;
    int (*step3)(void *, double, double, bool, bool *, bool *, bool *, double *) = NULL;
    int (*step2)(void *, double, double, int) = NULL;
    if (third) {
        void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool, const unsigned *, size_t,
                             void *, void (*)(void *, int, const char *, const char *), void *) =
            needed(library, "fmi3InstantiateCoSimulation");
        int (*enter)(void *, bool, double, double, bool, double) = needed(library, "fmi3EnterInitializationMode");
        int (*leave)(void *) = needed(library, "fmi3ExitInitializationMode");
        set = needed(library, "fmi3SetFloat64");
        get = needed(library, "fmi3GetFloat64");
        step3 = needed(library, "fmi3DoStep");
        instance = instantiate("rig", token, resources, false, false, false, false, NULL, 0, NULL, log3, NULL);
        if (instance == NULL)
            fail("no instance");
        check(set(instance, inputs, given_count, given, given_count), "fmi3SetFloat64");
        check(enter(instance, false, 0.0, 0.0, false, 0.0), "fmi3EnterInitializationMode");
        check(leave(instance), "fmi3ExitInitializationMode");
    } else {
        void *(*instantiate)(const char *, int, const char *, const char *, const struct callbacks2 *, int, int) =
            needed(library, "fmi2Instantiate");
        int (*setup)(void *, int, double, double, int, double) = needed(library, "fmi2SetupExperiment");
        int (*enter)(void *) = needed(library, "fmi2EnterInitializationMode");
        int (*leave)(void *) = needed(library, "fmi2ExitInitializationMode");
        set2 = needed(library, "fmi2SetReal");
        get2 = needed(library, "fmi2GetReal");
        step2 = needed(library, "fmi2DoStep");
        instance = instantiate("rig", 1, token, resources, &callbacks, 0, 0);
        if (instance == NULL)
            fail("no instance");
        check(setup(instance, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
        check(set2(instance, inputs, given_count, given), "fmi2SetReal");
        check(enter(instance), "fmi2EnterInitializationMode");
        check(leave(instance), "fmi2ExitInitializationMode");
    }
    for (int step = 0; step < 6000; step++) {
        if (third) {
            bool event, terminate, early;
            double reached;
            check(step3(instance, step / 100.0, 0.01, true, &event, &terminate, &early, &reached), "fmi3DoStep");
        } else {
            check(step2(instance, step / 100.0, 0.01, 1), "fmi2DoStep");
        }
        if (step % 100 != 99)
            continue;
        if (third)
            check(get(instance, watched, watched_count, values, watched_count), "fmi3GetFloat64");
        else
            check(get2(instance, watched, watched_count, values), "fmi2GetReal");
        write_values(values, watched_count);
    }
    void (*release)(void *) = needed(library, third ? "fmi3FreeInstance" : "fmi2FreeInstance");
    release(instance);
    return 0;
}
