/*
 * The derivatives of one mode, for replay.c. Follows the C that CasADi generates, with RATES and
 * RATES_ARG, RATES_RES, RATES_CHECKOUT, RATES_RELEASE its name and work sizes; SURFACE alike where
 * the model has switches.
 */
#define CALL(NAME)                                                                                 \
    const double *arg[NAME##_ARG] = {&t, x, u, p, s};                                              \
    double *res[NAME##_RES] = {out};                                                               \
    const int memory = NAME##_CHECKOUT();                                                          \
    const int failed = NAME(arg, res, iw, w, memory);                                              \
    NAME##_RELEASE(memory);                                                                        \
    return failed

int tangent_rates(double t, const double *x, const double *u, const double *p, const double *s,
                  double *out, long long *iw, double *w)
{
    CALL(RATES);
}

#ifdef SURFACE
int tangent_surface(double t, const double *x, const double *u, const double *p, const double *s,
                    double *out, long long *iw, double *w)
{
    CALL(SURFACE);
}
#endif
