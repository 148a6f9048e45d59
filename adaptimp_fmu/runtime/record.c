/* Failures of a contained model: recorded for the program around it, which formats them. */
#include <stdarg.h>

#include "instance.h"

/* Takes the next argument of the kind that a conversion asks for; none of them takes a width. */
static void record_argument(Failure *failure, char conversion, va_list *arguments) {
    if (failure->n == FAILURE_MAX_ARGUMENTS) return;
    FailureArgument *argument = &failure->arguments[failure->n++];
    argument->kind = conversion == 'u' ? 'd' : conversion;
    argument->text = "";
    argument->number = 0;
    if (conversion == 's') argument->text = va_arg(*arguments, const char *);
    if (conversion == 'g') argument->number = va_arg(*arguments, double);
    if (conversion == 'd') argument->number = va_arg(*arguments, int);
    if (conversion == 'u') argument->number = va_arg(*arguments, unsigned);
}

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
/* Records a sentence with its arguments, which must outlive the failure, and returns 0. */
static RARE int fail(const Instance *instance, const char *sentence, ...) {
    Failure *failure = instance->failure;
    va_list arguments;
    if (!failure) return 0;
    failure->component = NULL;
    failure->sentence = sentence;
    failure->n = 0;
    va_start(arguments, sentence);
    for (const char *c = sentence; *c; ++c) {
        if (*c != '%') continue;
        do ++c;
        while (*c == '.' || (*c >= '0' && *c <= '9'));
        if (*c == '\0') break;
        if (*c != '%') record_argument(failure, *c, &arguments);
    }
    va_end(arguments);
    return 0;
}
