/* Why a step, an initialization or a value was refused: recorded, not formatted, so that nothing here
 * needs memory or a library. */
#ifndef FAILURE_H
#define FAILURE_H

enum { FAILURE_MAX_ARGUMENTS = 6 };

typedef struct {
    char kind;                  /* 's': text, 'g': number, 'd': integer, of a conversion in the sentence */
    double number;              /* of the kinds 'g' and 'd' */
    const char *text;           /* of the kind 's' */
} FailureArgument;

/* The text is "component: " and the sentence, whose conversions (%s, %g, %.17g, %d, %u, as of printf) take
 * the arguments in their order. */
typedef struct {
    const char *component;      /* 0 if no component is to blame */
    const char *sentence;
    int n;                      /* number of arguments */
    FailureArgument arguments[FAILURE_MAX_ARGUMENTS];
} Failure;

#endif
