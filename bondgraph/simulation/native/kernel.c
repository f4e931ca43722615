/*
 * One Dormand-Prince 5(4) step of one mode of a model.
 *
 * Twice part of a translation unit (native.py joins them): before driver.c, which sees the types
 * alone; and after the C that CasADi generates for a mode, with these macros, so that the compiler
 * knows all sizes and can take the model into the loops:
 *
 *     N, M, K                 numbers of states, inputs, switches
 *     RHS, RHS_CHECKOUT, RHS_RELEASE, RHS_ARG, RHS_RES       name and work sizes; GUARD alike
 *     SMALL                   1 where the model may be copied into every stage
 *
 *     rhs   : (t, x, u, p, s) -> dx/dt [n], supplied power, dissipated power
 *     guard : (t, x, u, p, s) -> g [k], a [k]        an event is g falling below zero
 *         slipping switch: g = s*v, a = v (its slip);  stuck: g = breakaway - |a|, a = its force
 */
#include <float.h>
#include <math.h>
#include <string.h>

typedef long long i64;

/* A step under way: from t and x, with slope slopes[0], to x_new. */
typedef struct {
    double t, rtol, t_input;
    double *x, *x_new; /* [n+2] */
    double *slopes;    /* [7][n+2] */
    double *dense;     /* [5][n+2] coefficients of the interpolant */
    double *sample;    /* [5][2k] guards at the quarters of the step */
    double *floor;     /* [n] least size in which the error of a state is measured */
    const double *atol, *parameters, *codes;
    /* inputs at t_input, and what s, s^2 and s^3 are multiplied by, s the time since */
    const double *u, *u_slope, *u_bend, *u_twist;
    i64 *iw;
    double *w;
} Step;

typedef struct {
    unsigned long long stuck; /* bit j: switch j is stuck */
    int (*rhs)(const Step *, double t, const double *x, double *out);
    int (*guard)(const Step *, double t, const double *x, double *out);
    int (*advance)(Step *, double h);
    double (*finish)(Step *, double h);
    void (*inspect)(Step *, double h);
} Mode;

static inline double larger(double a, double b) { return a > b ? a : b; }

#define INTERPOLANT(d0, d1, d2, d3, d4, part)                                                      \
    (d0 + part * (d1 + (1 - part) * (d2 + part * (d3 + (1 - part) * d4))))

#ifdef N

#if SMALL
#define FLAT __attribute__((flatten))
#define SLOPE(number) double k##number[N + 2]
#define KEEP(number) memcpy(q->slopes + (number - 1) * (N + 2), k##number, sizeof k##number)
#else
#define FLAT
#define SLOPE(number) double *restrict k##number = q->slopes + (number - 1) * (N + 2)
#define KEEP(number)
#endif

#define ROOM(count) ((count) > 0 ? (count) : 1)
static inline void inputs(const Step *q, double t, double *u)
{
    const double s = t - q->t_input;
    for (int c = 0; c < M; c++)
        u[c] = q->u[c] + s * (q->u_slope[c] + s * (q->u_bend[c] + s * q->u_twist[c]));
}

static inline int model_rhs(const Step *q, double t, const double *x, double *out)
{
    double u[ROOM(M)];
    const double *arg[RHS_ARG] = {&t, x, u, q->parameters, q->codes};
    double *res[RHS_RES] = {out};
    inputs(q, t, u);
    const int memory = RHS_CHECKOUT();
    const int failed = RHS(arg, res, q->iw, q->w, memory);
    RHS_RELEASE(memory);
    return failed;
}

static inline int model_guard(const Step *q, double t, const double *x, double *out)
{
#if K > 0
    double u[ROOM(M)];
    const double *arg[GUARD_ARG] = {&t, x, u, q->parameters, q->codes};
    double *res[GUARD_RES] = {out};
    inputs(q, t, u);
    const int memory = GUARD_CHECKOUT();
    const int failed = GUARD(arg, res, q->iw, q->w, memory);
    GUARD_RELEASE(memory);
    return failed;
#else
    (void)q, (void)t, (void)x, (void)out;
    return 0;
#endif
}

int mode_rhs(const Step *q, double t, const double *x, double *out)
{
    return model_rhs(q, t, x, out);
}

int mode_guard(const Step *q, double t, const double *x, double *out)
{
    return model_guard(q, t, x, out);
}

/* x_new one step of length h after x; needs slope 1, fills slopes 2 to 6. */
FLAT int mode_advance(Step *q, double h)
{
    const double t = q->t, *restrict x = q->x, *restrict k1 = q->slopes;
    double *restrict x_new = q->x_new;
    double y[N + 2];
    int failed = 0;
    SLOPE(2);
    SLOPE(3);
    SLOPE(4);
    SLOPE(5);
    SLOPE(6);

    /* each sum ends with the newest slope, for which alone it has to wait */
    for (int i = 0; i < N; i++) y[i] = x[i] + h * (1.0 / 5.0) * k1[i];
    failed |= model_rhs(q, t + h * (1.0 / 5.0), y, k2);
    for (int i = 0; i < N; i++)
        y[i] = x[i] + h * (3.0 / 40.0 * k1[i]) + h * (9.0 / 40.0) * k2[i];
    failed |= model_rhs(q, t + h * (3.0 / 10.0), y, k3);
    for (int i = 0; i < N; i++)
        y[i] = x[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i]) + h * (32.0 / 9.0) * k3[i];
    failed |= model_rhs(q, t + h * (4.0 / 5.0), y, k4);
    for (int i = 0; i < N; i++)
        y[i] = x[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i]
                           + 64448.0 / 6561.0 * k3[i])
               - h * (212.0 / 729.0) * k4[i];
    failed |= model_rhs(q, t + h * (8.0 / 9.0), y, k5);
    for (int i = 0; i < N; i++)
        y[i] = x[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i]
                           + 46732.0 / 5247.0 * k3[i] + 49.0 / 176.0 * k4[i])
               - h * (5103.0 / 18656.0) * k5[i];
    failed |= model_rhs(q, t + h, y, k6);
    for (int i = 0; i < N + 2; i++)
        x_new[i] = x[i] + h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i]
                               + 125.0 / 192.0 * k4[i] - 2187.0 / 6784.0 * k5[i])
                   + h * (11.0 / 84.0) * k6[i];
    KEEP(2);
    KEEP(3);
    KEEP(4);
    KEEP(5);
    KEEP(6);
    return failed;
}

/*
 * Slope 7 and the largest component of the error estimate in units of what the tolerances allow;
 * -1 when the step holds a NaN or an infinity.
 */
FLAT double mode_finish(Step *q, double h)
{
    const double *restrict x = q->x, *restrict x_new = q->x_new, *restrict k = q->slopes;
    double norm = 0, zero = 0, last[N + 2];
    const int failed = model_rhs(q, q->t + h, x_new, last);
    for (int i = 0; i < N + 2; i++) zero += 0 * x_new[i] + 0 * last[i];
    memcpy(q->slopes + 6 * (N + 2), last, sizeof last);
    for (int i = 0; i < N; i++) {
        const double e = h * (71.0 / 57600.0 * k[i] - 71.0 / 16695.0 * k[i + 2 * (N + 2)]
                              + 71.0 / 1920.0 * k[i + 3 * (N + 2)]
                              - 17253.0 / 339200.0 * k[i + 4 * (N + 2)]
                              + 22.0 / 525.0 * k[i + 5 * (N + 2)] - 1.0 / 40.0 * last[i]);
        const double size = larger(larger(fabs(x[i]), fabs(x_new[i])), q->floor[i]);
        const double allowed = q->atol[i] + q->rtol * size;
        norm = larger(norm, fabs(e) / larger(allowed, DBL_MIN));
    }
    return failed || zero != 0 ? -1 : norm;
}

/* The interpolant over a finished step, and the guards at its quarters. */
FLAT void mode_inspect(Step *q, double h)
{
    const double *restrict x = q->x, *restrict x_new = q->x_new, *restrict k = q->slopes;
    double *restrict d = q->dense;
    for (int i = 0; i < N + 2; i++) {
        const double rise = x_new[i] - x[i], bend = h * k[i] - rise;
        d[i] = x[i];
        d[i + (N + 2)] = rise;
        d[i + 2 * (N + 2)] = bend;
        d[i + 3 * (N + 2)] = rise - h * k[i + 6 * (N + 2)] - bend;
        d[i + 4 * (N + 2)] = h * (-12715105075.0 / 11282082432.0 * k[i]
                                  + 87487479700.0 / 32700410799.0 * k[i + 2 * (N + 2)]
                                  - 10690763975.0 / 1880347072.0 * k[i + 3 * (N + 2)]
                                  + 701980252875.0 / 199316789632.0 * k[i + 4 * (N + 2)]
                                  - 1453857185.0 / 822651844.0 * k[i + 5 * (N + 2)]
                                  + 69997945.0 / 29380423.0 * k[i + 6 * (N + 2)]);
    }
#if K > 0
    for (int c = 1; c < 4; c++) {
        const double part = 0.25 * c;
        double y[N + 2];
        for (int i = 0; i < N; i++)
            y[i] = INTERPOLANT(d[i], d[i + (N + 2)], d[i + 2 * (N + 2)], d[i + 3 * (N + 2)],
                               d[i + 4 * (N + 2)], part);
        model_guard(q, q->t + part * h, y, q->sample + 2 * K * c);
    }
    model_guard(q, q->t + h, x_new, q->sample + 2 * K * 4);
#endif
}

#endif
