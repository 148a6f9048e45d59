/* A function and a table under names that another FMU has, too. */
#ifndef HELPER_H
#define HELPER_H

extern double table[2];
double helper(double u);

#endif
