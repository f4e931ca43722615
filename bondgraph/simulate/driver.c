/*
 * Event-driven Dormand-Prince 5(4) integration of a model with dry-friction switches.
 *
 * This file knows no model: a mode (the set of stuck switches) is a pair of functions in CasADi's
 * calling convention,
 *
 *     rhs   : (t, x, u, p, s) -> dx/dt [n], supplied power, dissipated power
 *     guard : (t, x, u, p, s) -> g [k], a [k]        an event is g falling below zero
 *         slipping switch: g = s*v, a = v (its slip);  stuck: g = breakaway - |a|, a = its force
 *
 * stepper.py is the same algorithm, line by line, in Python: change both together.
 *
 * halfarrow_advance() runs until it is done or needs its caller: an unknown mode, room for rows or
 * events, or a look at the clock. All state is in `Run`, so the caller serves the request and calls
 * again. Every phase checks what it needs before it changes anything, and so can be entered twice.
 */
#define _POSIX_C_SOURCE 199309L
#include <float.h>
#include <math.h>
#include <string.h>
#include <time.h>

typedef long long i64;
typedef int (*Model)(const double **arg, double **res, i64 *iw, double *w, int mem);

typedef struct {
    unsigned long long stuck; /* bit j: switch j is stuck */
    Model rhs, guard;
    i64 rhs_memory, guard_memory;
} Mode;

/* What halfarrow_advance returns; from FINISHED on it is an outcome. */
enum { CONTINUE, NEED_MODE, ROWS_FULL, EVENTS_FULL, PAUSED,
       FINISHED, EVENT_LIMIT, CHATTERING, STEP_UNDERFLOW, STEP_LIMIT, NON_FINITE, DIVERGED };

enum { BEGIN, CLASSIFY, RESTART, STEP, EMIT, SETTLE, KNOT, CONCLUDE };

/* Every field is 8 bytes wide; hybrid.py mirrors the part above "private". */
typedef struct {
    /* given by the caller */
    i64 n, m, k, n_knots, n_eval, n_modes, row_capacity, event_capacity, max_steps, max_events;
    double t_end, rtol, max_step, bound, energy0, slice;
    const double *x0, *parameters, *atol, *weights, *knots, *values, *t_eval;
    const signed char *hold;
    const Mode *modes;
    const double **arg;
    double **res;
    i64 *iw;
    double *w;
    double *rows;           /* [n+3] each: t, x, supplied, dissipated */
    signed char *row_codes; /* [k] each */
    double *events;         /* [n+3] each, as rows */
    i64 *event_codes;       /* [3] each: switch, code before, code after */
    double *x_end;          /* [n+2], written on return */
    signed char *code;      /* [k] */
    double *work;
    signed char *flags;
    /* both ways */
    double t;
    i64 row_count, event_count, steps, rejected, evaluations;
    unsigned long long wanted;
    /* private */
    i64 phase, outcome, mode, knot, next_eval, started, keep_step, unresolved, event_pending;
    i64 after_rejection, bad, shrinks, halvings, futile, settled, dense_ready;
    double h, h_used, t_new, t_begin, log_error, energy;
    double *x, *x_new, *K[7], *stage, *dense[5], *u, *s, *s_probe, *floor, *wobbled;
    double *sample[5], *probe, *noise, *probe_noise, *instants;
    signed char *next, *armed, *armed_low, *fired, *fresh;
} Run;

/* ---------------------------------------------------------------------------- constants */

static const double FAC_MIN = 0.2, FAC_MAX = 5.0, SAFETY = 0.9, BETA = 0.04;
static const double WOBBLE = 1.0 / 1048576.0; /* relative change of x that shows rounding of g */
#define WINDOW(k) (64 + 8 * (k))              /* events that must not share one instant */
enum { MAX_BAD = 20, MAX_SHRINKS = 6, MAX_HALVINGS = 6 };

static double larger(double a, double b) { return a > b ? a : b; }
static double smaller(double a, double b) { return a < b ? a : b; }
static double ulp(double t) { return DBL_EPSILON * larger(fabs(t), DBL_MIN); }
static int sign(double a) { return a < 0 ? -1 : 1; }

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---------------------------------------------------------------------------- memory */

i64 halfarrow_work_size(i64 n, i64 m, i64 k)
{
    return 17 * (n + 2) + m + 2 * k + 16 * k + WINDOW(k);
}

i64 halfarrow_flag_size(i64 k) { return 5 * k; }

i64 halfarrow_run_size(void) { return (i64)sizeof(Run); }

static double *take(double **from, i64 count)
{
    double *taken = *from;
    *from += count;
    return taken;
}

static void lay_out(Run *r)
{
    const i64 N = r->n + 2, k = r->k;
    double *free = r->work;
    r->x = take(&free, N);
    r->x_new = take(&free, N);
    for (int i = 0; i < 7; i++) r->K[i] = take(&free, N);
    for (int i = 0; i < 5; i++) r->dense[i] = take(&free, N);
    r->stage = take(&free, N);
    r->floor = take(&free, N);
    r->wobbled = take(&free, N);
    r->u = take(&free, r->m);
    r->s = take(&free, k);
    r->s_probe = take(&free, k);
    for (int i = 0; i < 5; i++) r->sample[i] = take(&free, 2 * k);
    r->probe = take(&free, 2 * k);
    r->noise = take(&free, 2 * k);
    r->probe_noise = take(&free, 2 * k);
    r->instants = take(&free, WINDOW(k));
    r->next = r->flags;
    r->armed = r->flags + k;
    r->armed_low = r->flags + 2 * k;
    r->fired = r->flags + 3 * k;
    r->fresh = r->flags + 4 * k;
}

/* ---------------------------------------------------------------------------- model */

/* Inputs at t, which lies in the interval after r->knot (the step never leaves it). */
static void set_inputs(Run *r, double t)
{
    const i64 m = r->m, i = r->knot;
    if (m == 0) return;
    if (i < 0 || i + 1 >= r->n_knots) {
        memcpy(r->u, r->values + (i < 0 ? 0 : i) * m, (size_t)m * sizeof(double));
        return;
    }
    const double part = (t - r->knots[i]) / (r->knots[i + 1] - r->knots[i]);
    const double *left = r->values + i * m, *right = left + m;
    for (i64 c = 0; c < m; c++)
        r->u[c] = r->hold[c] ? left[c] + part * (right[c] - left[c]) : left[c];
}

static int call(Run *r, Model f, i64 memory, const double *s, double t, const double *x, double *out)
{
    set_inputs(r, t);
    r->arg[0] = &t;
    r->arg[1] = x;
    r->arg[2] = r->u;
    r->arg[3] = r->parameters;
    r->arg[4] = s;
    r->res[0] = out;
    return f(r->arg, r->res, r->iw, r->w, (int)memory);
}

static int rhs(Run *r, double t, const double *x, double *out)
{
    const Mode *mode = r->modes + r->mode;
    r->evaluations++;
    return call(r, mode->rhs, mode->rhs_memory, r->s, t, x, out);
}

static void guard(Run *r, double t, const double *x, double *out)
{
    const Mode *mode = r->modes + r->mode;
    call(r, mode->guard, mode->guard_memory, r->s, t, x, out);
}

/* Index of the mode in which exactly the switches with code 0 stick; -1 asks the caller for it. */
static i64 find_mode(Run *r, const signed char *code)
{
    unsigned long long stuck = 0;
    for (i64 j = 0; j < r->k; j++)
        if (code[j] == 0) stuck |= 1ULL << j;
    for (i64 i = 0; i < r->n_modes; i++)
        if (r->modes[i].stuck == stuck) return i;
    r->wanted = stuck;
    return -1;
}

/*
 * Guards g, a of a mode at the present point, and how far rounding can move each: the change under
 * a small scattered change of the state, scaled down to the precision of a double.
 */
static void measure(Run *r, i64 mode, const signed char *code, double *g, double *noise)
{
    const Model f = r->modes[mode].guard;
    const i64 memory = r->modes[mode].guard_memory;
    for (i64 j = 0; j < r->k; j++) r->s_probe[j] = code[j];
    for (i64 i = 0; i < r->n; i++) {
        const double golden = (double)i * 0.6180339887498949;
        const double scatter = 0.5 + (golden - floor(golden));
        r->wobbled[i] = r->x[i] * (1.0 + WOBBLE * (i % 2 ? -scatter : scatter));
    }
    call(r, f, memory, r->s_probe, r->t, r->x, g);
    call(r, f, memory, r->s_probe, r->t, r->wobbled, noise);
    for (i64 j = 0; j < 2 * r->k; j++)
        noise[j] = 64 * DBL_EPSILON * (fabs(noise[j] - g[j]) / WOBBLE + fabs(g[j]));
}

/* ---------------------------------------------------------------------------- one step */

/* x_new one Dormand-Prince step of length h after x; needs K[0], fills K[1] to K[5]. */
static int stages(Run *r, double h)
{
    const i64 n = r->n;
    const double t = r->t;
    const double *restrict x = r->x;
    double *restrict y = r->stage;
    double *restrict k1 = r->K[0], *restrict k2 = r->K[1], *restrict k3 = r->K[2];
    double *restrict k4 = r->K[3], *restrict k5 = r->K[4], *restrict k6 = r->K[5];
    double *restrict x_new = r->x_new;
    int failed = 0;

    for (i64 i = 0; i < n; i++) y[i] = x[i] + h * (1.0 / 5.0 * k1[i]);
    failed |= rhs(r, t + h * (1.0 / 5.0), y, k2);
    for (i64 i = 0; i < n; i++) y[i] = x[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i]);
    failed |= rhs(r, t + h * (3.0 / 10.0), y, k3);
    for (i64 i = 0; i < n; i++)
        y[i] = x[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i]);
    failed |= rhs(r, t + h * (4.0 / 5.0), y, k4);
    for (i64 i = 0; i < n; i++)
        y[i] = x[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i]
                           + 64448.0 / 6561.0 * k3[i] - 212.0 / 729.0 * k4[i]);
    failed |= rhs(r, t + h * (8.0 / 9.0), y, k5);
    for (i64 i = 0; i < n; i++)
        y[i] = x[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i]
                           + 46732.0 / 5247.0 * k3[i] + 49.0 / 176.0 * k4[i]
                           - 5103.0 / 18656.0 * k5[i]);
    failed |= rhs(r, t + h, y, k6);
    for (i64 i = 0; i < n + 2; i++)
        x_new[i] = x[i] + h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i]
                               + 125.0 / 192.0 * k4[i] - 2187.0 / 6784.0 * k5[i]
                               + 11.0 / 84.0 * k6[i]);
    return failed;
}

/* K[6], the slope after the step; nonzero when the step holds a NaN or an infinity. */
static int last_stage(Run *r, double h)
{
    double zero = 0;
    if (rhs(r, r->t + h, r->x_new, r->K[6])) return 1;
    for (i64 i = 0; i < r->n + 2; i++) zero += 0 * r->x_new[i] + 0 * r->K[6][i];
    return zero != 0;
}

/* Largest component of the error estimate, in units of what the tolerances allow. */
static double error_norm(const Run *r, double h)
{
    double norm = 0;
    for (i64 i = 0; i < r->n; i++) {
        const double e = h * (71.0 / 57600.0 * r->K[0][i] - 71.0 / 16695.0 * r->K[2][i]
                              + 71.0 / 1920.0 * r->K[3][i] - 17253.0 / 339200.0 * r->K[4][i]
                              + 22.0 / 525.0 * r->K[5][i] - 1.0 / 40.0 * r->K[6][i]);
        const double size = larger(larger(fabs(r->x[i]), fabs(r->x_new[i])), r->floor[i]);
        const double allowed = r->atol[i] + r->rtol * size;
        norm = larger(norm, fabs(e) / larger(allowed, DBL_MIN));
    }
    return norm;
}

static void make_dense(Run *r, double h)
{
    for (i64 i = 0; i < r->n + 2; i++) {
        const double rise = r->x_new[i] - r->x[i];
        const double bend = h * r->K[0][i] - rise;
        r->dense[0][i] = r->x[i];
        r->dense[1][i] = rise;
        r->dense[2][i] = bend;
        r->dense[3][i] = rise - h * r->K[6][i] - bend;
        r->dense[4][i] = h * (-12715105075.0 / 11282082432.0 * r->K[0][i]
                              + 87487479700.0 / 32700410799.0 * r->K[2][i]
                              - 10690763975.0 / 1880347072.0 * r->K[3][i]
                              + 701980252875.0 / 199316789632.0 * r->K[4][i]
                              - 1453857185.0 / 822651844.0 * r->K[5][i]
                              + 69997945.0 / 29380423.0 * r->K[6][i]);
    }
    r->dense_ready = 1;
}

/* The first `count` components at the fraction `part` of the step. */
static void interpolate(const Run *r, double part, i64 count, double *restrict out)
{
    const double *const *d = (const double *const *)r->dense;
    const double rest = 1 - part;
    for (i64 i = 0; i < count; i++)
        out[i] = d[0][i] + part * (d[1][i] + rest * (d[2][i] + part * (d[3][i] + rest * d[4][i])));
}

/*
 * First step after a start or an event: from the rate at which the slope turns over a small Euler
 * step, in the manner of Hairer, Norsett and Wanner but free of the unit of time.
 */
static void first_step(Run *r)
{
    const i64 n = r->n;
    const double remaining = r->t_end - r->t;
    double small = r->h > 0 ? 0.01 * r->h : 1e-6 * remaining;
    double size = 0, slope = 0;
    for (i64 i = 0; i < n; i++) {
        const double allowed = r->atol[i] + r->rtol * larger(fabs(r->x[i]), r->floor[i]);
        if (allowed > 0) {
            size = larger(size, fabs(r->x[i]) / allowed);
            slope = larger(slope, fabs(r->K[0][i]) / allowed);
        }
    }
    if (slope > 0 && size > 0) small = smaller(small, 0.01 * size / slope);
    small = smaller(small, smaller(r->max_step, remaining));
    for (int tries = 0; tries < 12; tries++) {
        double turn = 0, zero = 0;
        slope = 0;
        for (i64 i = 0; i < n; i++) r->stage[i] = r->x[i] + small * r->K[0][i];
        const int failed = rhs(r, r->t + small, r->stage, r->K[1]);
        for (i64 i = 0; i < n; i++) {
            const double reach = larger(fabs(r->x[i]), fabs(r->stage[i]));
            const double allowed = r->atol[i] + r->rtol * larger(reach, r->floor[i]);
            const double change = fabs(r->K[1][i] - r->K[0][i]);
            zero += 0 * r->K[1][i];
            if (allowed > 0) {
                slope = larger(slope, fabs(r->K[0][i]) / allowed);
                turn = larger(turn, change / allowed / small);
            }
        }
        if (failed || zero != 0) {
            small *= 0.1;
            continue;
        }
        r->h = 100 * small;
        if (slope > 0 && turn > 0) {
            const double rate = turn / slope;
            r->h = smaller(r->h, pow(10 * rate / slope, 0.2) / rate);
        }
        return;
    }
    r->h = small;
}

/* ---------------------------------------------------------------------------- events inside a step */

typedef double (*Level)(Run *r, double tau);

/* The lowest armed guard; one that never rose yet counts as below zero only beyond rounding. */
static double lowest(const Run *r, const double *g)
{
    double level = INFINITY;
    for (i64 j = 0; j < r->k; j++)
        level = smaller(level, r->armed_low[j] ? g[j] : g[j] + r->noise[j]);
    return level;
}

static double level_dense(Run *r, double tau)
{
    interpolate(r, tau / r->h_used, r->n, r->stage);
    guard(r, r->t + tau, r->stage, r->probe);
    return lowest(r, r->probe);
}

static double level_true(Run *r, double tau)
{
    stages(r, tau);
    guard(r, r->t + tau, r->x_new, r->probe);
    return lowest(r, r->probe);
}

/* Where between a and b three points put the zero, 1/2 where that is not safe. */
static double inverse_quadratic(double a, double fa, double b, double fb, double c, double fc)
{
    if (c == b || fc == fa || fc == fb) return 0.5;
    const double xi = (a - b) / (c - b), phi = (fa - fb) / (fc - fb);
    if (!(phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi)) return 0.5;
    const double across = fa / (fb - fa) * fc / (fb - fc);
    return across + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb);
}

/*
 * Narrows low (level >= 0) and high (level < 0) to within about 2 tol: Chandrupatla's method,
 * started by a secant.
 */
static void narrow(Run *r, Level level, double *low, double f_low, double *high, double f_high,
                   double tol)
{
    double a = *low, fa = f_low, b = *high, fb = f_high, c = a, fc = fa;
    double part = fa / (fa - fb);
    for (int i = 0; i < 80; i++) {
        const double least = tol / fabs(b - a);
        if (!(least < 0.5)) break;
        part = smaller(1 - least, larger(least, part));
        const double x = a + part * (b - a), f = level(r, x);
        if ((f >= 0) == (fa >= 0)) {
            c = a;
            fc = fa;
        } else {
            c = b;
            fc = fb;
            b = a;
            fb = fa;
        }
        a = x;
        fa = f;
        part = inverse_quadratic(a, fa, b, fb, c, fc);
    }
    *low = fa >= 0 ? a : b;
    *high = fa >= 0 ? b : a;
}

/* armed_low: which guards are armed at sample `at`. */
static void arm_until(Run *r, int at)
{
    for (i64 j = 0; j < r->k; j++) {
        r->armed_low[j] = r->armed[j];
        for (int c = 1; c <= at; c++)
            if (r->sample[c][j] > r->noise[j]) r->armed_low[j] = 1;
    }
}

/* Index of the first sample with a guard below zero, 5 if none; armed_low as just before it. */
static int first_below(Run *r)
{
    memcpy(r->armed_low, r->armed, (size_t)r->k);
    for (int c = 1; c < 5; c++) {
        if (lowest(r, r->sample[c]) < 0) return c;
        for (i64 j = 0; j < r->k; j++)
            if (r->sample[c][j] > r->noise[j]) r->armed_low[j] = 1;
    }
    return 5;
}

/*
 * A guard over the step as smooth curves through its five samples: slipping, g = s*a; stuck,
 * g = b - |a| with b the breakaway force. (g itself has a kink where a changes sign.) Curves are
 * kept as Newton's forward differences: d[4] is what a cubic would miss.
 */
typedef struct {
    double a[5], b[5], s;
} Curve;

static void difference(double *d)
{
    for (int order = 1; order < 5; order++)
        for (int c = 4; c >= order; c--) d[c] -= d[c - 1];
}

static Curve make_curve(const Run *r, i64 j)
{
    Curve curve = {.s = r->code[j]};
    for (int c = 0; c < 5; c++) {
        curve.a[c] = r->sample[c][r->k + j];
        curve.b[c] = curve.s != 0 ? 0 : r->sample[c][j] + fabs(curve.a[c]);
    }
    difference(curve.a);
    difference(curve.b);
    return curve;
}

/* Value at z quarters of the step. */
static double quartic(const double *d, double z)
{
    return d[0] + z * (d[1] + (z - 1) / 2 * (d[2] + (z - 2) / 3 * (d[3] + (z - 3) / 4 * d[4])));
}

static double on_curve(const Curve *c, double z)
{
    const double a = quartic(c->a, z);
    return c->s != 0 ? c->s * a : quartic(c->b, z) - fabs(a);
}

static double roughness(const Curve *c) { return fabs(c->a[4]) + fabs(c->b[4]); }

/* Bound of the second differences anywhere in the step. */
static double bend(const Curve *c)
{
    double sum = 0;
    for (int order = 2; order < 5; order++)
        sum += (order - 1) * (fabs(c->a[order]) + fabs(c->b[order]));
    return sum;
}

/* Where between two samples, in quarters of the step, a curve is lowest; 0 if at the ends. */
static double lowest_inside(const Curve *curve, int from, int to, double *value)
{
    const double dz = 0.125;
    int at = 8 * from;
    double least = INFINITY;
    for (int i = 8 * from; i <= 8 * to; i++) {
        const double g = on_curve(curve, dz * i);
        if (g < least) {
            least = g;
            at = i;
        }
    }
    if (at == 8 * from || at == 8 * to) return 0;
    const double left = on_curve(curve, dz * (at - 1)), right = on_curve(curve, dz * (at + 1));
    const double tilt = 0.5 * (right - left), turn = left - 2 * least + right;
    *value = least - (turn > 0 ? 0.5 * tilt * tilt / turn : 0);
    return dz * (at - (turn > 0 ? tilt / turn : 0));
}

/*
 * A dip below zero between samples that are all above it: predicted from the curves, tried on the
 * interpolant. Returns the fraction of the step, 0 if none, and the sample before it.
 */
static double find_dip(Run *r, int before, int *low)
{
    for (i64 j = 0; j < r->k; j++) {
        int from = 0;
        double least = INFINITY, value = 0;
        while (from < before && !r->armed[j] && !(r->sample[from][j] > r->noise[j])) from++;
        for (int c = from; c < before; c++) least = smaller(least, r->sample[c][j]);
        const Curve curve = make_curve(r, j);
        if (least > 0.25 * bend(&curve)) continue;
        const double z = lowest_inside(&curve, from, before - 1, &value);
        if (z == 0 || value > 0.1 * roughness(&curve)) continue;
        arm_until(r, (int)z);
        if (level_dense(r, 0.25 * z * r->h_used) < 0) {
            *low = (int)z;
            return 0.25 * z;
        }
    }
    return 0;
}

/*
 * Whether a guard wobbles so much that a dip below zero could hide between samples before `first`.
 * The state's error control does not see a force that depends on time alone while all is stuck.
 */
static int guards_unresolved(const Run *r, int first)
{
    for (i64 j = 0; j < r->k; j++) {
        double least = INFINITY, change = 0;
        if (!r->armed[j]) continue;
        const Curve curve = make_curve(r, j);
        for (int c = 0; c < first; c++) least = smaller(least, r->sample[c][j]);
        for (int c = 1; c < 5; c++)
            change = larger(change, fabs(r->sample[c][r->k + j] - r->sample[c - 1][r->k + j]));
        const double rough = roughness(&curve);
        if (rough > 0.1 * change && rough > 0.1 * least) return 1;
    }
    return 0;
}

enum { WHOLE, RETRY, TRUNCATED, EVENT };

/*
 * The event in (low, high], as offsets from the step's start, by steps of the method itself from
 * there: the state at the event is as good as one after a whole step. Leaves it in x_new, its time
 * in h_used and the switches in `fired`. Where the true solution stays above zero although its
 * interpolant does not, the step is cut at `high` (TRUNCATED).
 */
static int locate(Run *r, double h, double low, double high)
{
    const double limit = high, tol = 2 * ulp(larger(fabs(r->t), fabs(r->t + h)));
    double f_low = level_dense(r, low), f_high = level_dense(r, high), reach = 1e-6 * h;
    if (f_low >= 0 && f_high < 0) narrow(r, level_dense, &low, f_low, &high, f_high, 1e-9 * h);

    f_high = level_true(r, high);
    if (f_high < 0) {
        for (low = high; ; reach *= 32) {
            low = larger(low - reach, 0);
            if (low == 0) {
                f_low = larger(lowest(r, r->sample[0]), 0);
                break;
            }
            f_low = level_true(r, low);
            if (f_low >= 0) break;
            high = low;
            f_high = f_low;
        }
    } else {
        for (;; reach *= 32) {
            low = high;
            f_low = f_high;
            high = smaller(low + reach, limit);
            f_high = high > low ? level_true(r, high) : f_low;
            if (f_high < 0) break;
            if (high >= limit) {
                r->h_used = limit;
                return TRUNCATED;
            }
        }
    }
    narrow(r, level_true, &low, f_low, &high, f_high, tol);
    level_true(r, high);
    for (i64 j = 0; j < r->k; j++)
        r->fired[j] = r->probe[j] + (r->armed_low[j] ? 0 : r->noise[j]) < 0;
    level_true(r, low);
    r->h_used = low;
    return EVENT;
}

/* Looks for events in the step of length h that ends in x_new. */
static int search(Run *r, double h)
{
    const i64 k = r->k;
    int low;
    double part;
    make_dense(r, h);
    r->h_used = h;
    for (int c = 1; c < 4; c++) {
        interpolate(r, 0.25 * c, r->n, r->stage);
        guard(r, r->t + 0.25 * c * h, r->stage, r->sample[c]);
    }
    guard(r, r->t + h, r->x_new, r->sample[4]);

    const int first = first_below(r);
    if (r->halvings < MAX_HALVINGS && guards_unresolved(r, first)) {
        r->halvings++;
        r->h = 0.5 * h;
        return RETRY;
    }
    if ((part = find_dip(r, first, &low)) > 0) {
        ; /* armed_low is as at the sample before the dip */
    } else if (first < 5) {
        arm_until(r, first - 1);
        low = first - 1;
        part = 0.25 * first;
        for (i64 j = 0; j < k; j++) {
            /* It fell without ever having risen. Either the step was too long for the little that
             * it should have risen, or the last decision was wrong: first try shorter steps. */
            const int suspicious = !r->armed_low[j] && r->sample[first][j] < -r->noise[j];
            if (suspicious && r->shrinks < MAX_SHRINKS && h > 1000 * ulp(r->t)) {
                r->shrinks++;
                r->h = 0.125 * h;
                return RETRY;
            }
        }
    } else {
        memcpy(r->armed, r->armed_low, (size_t)k);
        return WHOLE;
    }

    const int found = locate(r, h, 0.25 * low * h, part * h);
    if (last_stage(r, r->h_used)) {
        r->bad++;
        r->h = 0.25 * h;
        return RETRY;
    }
    make_dense(r, r->h_used);
    guard(r, r->t + r->h_used, r->x_new, r->sample[4]);
    for (i64 j = 0; j < k; j++)
        r->armed[j] = r->armed_low[j] || r->sample[4][j] > r->noise[j];
    return found;
}

/* ---------------------------------------------------------------------------- phases */

static i64 conclude(Run *r, i64 outcome)
{
    r->outcome = outcome;
    r->phase = CONCLUDE;
    return CONTINUE;
}

static i64 begin(Run *r)
{
    const i64 n = r->n;
    double zero = 0;
    lay_out(r);
    memcpy(r->x, r->x0, (size_t)n * sizeof(double));
    r->x[n] = r->x[n + 1] = 0;
    r->t_begin = r->t;
    r->energy = fabs(r->energy0);
    for (i64 i = 0; i < n; i++) {
        zero += 0 * r->x[i];
        r->floor[i] = larger(1e-3 * fabs(r->x[i]), 1e-7 * r->weights[i] * sqrt(2 * r->energy));
    }
    r->knot = -1;
    while (r->knot + 1 < r->n_knots && r->knots[r->knot + 1] <= r->t) r->knot++;
    r->log_error = log(1e-4);
    r->phase = CLASSIFY;
    return zero != 0 ? conclude(r, NON_FINITE) : CONTINUE;
}

static int row_missing(const Run *r) { return r->row_count >= r->row_capacity; }

static void put_row(Run *r, double t, const double *x)
{
    double *row = r->rows + r->row_count * (r->n + 3);
    row[0] = t;
    if (x)
        memcpy(row + 1, x, (size_t)(r->n + 2) * sizeof(double));
    else
        interpolate(r, (t - r->t) / r->h_used, r->n + 2, row + 1);
    if (r->k) memcpy(r->row_codes + r->row_count * r->k, r->code, (size_t)r->k);
    r->row_count++;
}

/*
 * Releases from `next`, whose fresh sticks are only tried, the worst overloaded switch after the
 * other until those still stuck hold. Returns CONTINUE, NEED_MODE or NON_FINITE.
 */
static i64 release(Run *r)
{
    for (;;) {
        const i64 mode = find_mode(r, r->next);
        i64 worst = -1;
        double most = 0;
        if (mode < 0) return NEED_MODE;
        measure(r, mode, r->next, r->probe, r->probe_noise);
        for (i64 j = 0; j < r->k; j++) {
            const double g = r->probe[j], load = fabs(r->probe[r->k + j]);
            if (!isfinite(g) || !isfinite(load)) return NON_FINITE;
            if (r->next[j] == 0 && g < -r->probe_noise[j] && -g / load > most) {
                worst = j;
                most = -g / load;
            }
        }
        if (worst < 0) return CONTINUE;
        r->next[worst] = (signed char)sign(r->probe[r->k + worst]);
    }
}

/* Takes over the codes in `next`: logs what changed, and the state on the new side. */
static i64 adopt(Run *r)
{
    const i64 n = r->n, k = r->k;
    int changed = 0;
    for (i64 j = 0; j < k; j++) changed += r->next[j] != r->code[j];
    if (changed || !r->started) {
        if (r->started && r->event_count + changed > r->max_events) return conclude(r, EVENT_LIMIT);
        if (r->event_count + changed > r->event_capacity) return EVENTS_FULL;
        if (!r->t_eval && row_missing(r)) return ROWS_FULL;
    }
    for (i64 j = 0; j < k && r->started; j++) {
        if (r->next[j] == r->code[j]) continue;
        double *event = r->events + r->event_count * (n + 3);
        i64 *codes = r->event_codes + 3 * r->event_count++;
        event[0] = r->t;
        memcpy(event + 1, r->x, (size_t)(n + 2) * sizeof(double));
        codes[0] = j;
        codes[1] = r->code[j];
        codes[2] = r->next[j];
    }
    for (i64 j = 0; j < k; j++) r->s[j] = r->code[j] = r->next[j];
    if (!r->t_eval && (changed || !r->started)) put_row(r, r->t, r->x);
    if (changed) r->keep_step = 0;
    r->started = 1;
    r->phase = RESTART;
    return CONTINUE;
}

/*
 * Codes from the slips themselves, at the start and where an input jumped: the mode without any
 * stick gives every slip. A slip of rounding size is a stick, if the breakaway force holds it.
 */
static i64 classify(Run *r)
{
    const i64 k = r->k;
    i64 status;
    memset(r->next, 1, (size_t)k);
    if (k) {
        const i64 mode = find_mode(r, r->next);
        if (mode < 0) return NEED_MODE;
        measure(r, mode, r->next, r->probe, r->probe_noise);
        for (i64 j = 0; j < k; j++) {
            const double slip = r->probe[k + j];
            if (!isfinite(slip)) return conclude(r, NON_FINITE);
            /* 150 times the rounding of one evaluation: what a long stick may have gathered */
            const int still = fabs(slip) <= 150 * r->probe_noise[k + j];
            r->next[j] = (signed char)(still ? 0 : sign(slip));
            r->fresh[j] = (signed char)still;
        }
        if ((status = release(r)) != CONTINUE)
            return status == NON_FINITE ? conclude(r, status) : status;
    }
    return adopt(r);
}

/* New codes at an event: what was overloaded slips, what came to rest is tried as a stick. */
static i64 settle(Run *r)
{
    const i64 k = r->k;
    const double *g = r->sample[0], *force = g + k;
    int early = 0;
    for (i64 j = 0; j < k; j++) {
        const int slips = r->code[j] != 0;
        const int rests = slips && r->armed_low[j] && g[j] <= r->noise[j];
        r->next[j] = r->code[j];
        if (r->fired[j] && !slips) r->next[j] = (signed char)sign(force[j]);
        if ((r->fired[j] || rests) && slips) r->next[j] = 0;
        r->fresh[j] = r->fired[j] || rests || !slips;
        early |= r->fired[j] && !r->armed_low[j];
    }
    const i64 status = release(r);
    if (status != CONTINUE) return status == NON_FINITE ? conclude(r, status) : status;

    if (r->unresolved) { /* count this event once, however often the phase is entered */
        const i64 window = WINDOW(k), slot = r->settled % window;
        const double span = r->t - r->instants[slot];
        const int crowded = r->settled >= window
                            && span <= 1e-12 * (r->t_end - r->t_begin) + 1000 * ulp(r->t);
        r->futile = early ? r->futile + 1 : 0;
        if (crowded || r->futile > 16 + 4 * k) return conclude(r, CHATTERING);
        r->instants[slot] = r->t;
        r->settled++;
        r->unresolved = 0;
    }
    return adopt(r);
}

/* Slope, guards and step size of the present mode at the present point. */
static i64 restart(Run *r)
{
    double zero = 0;
    const i64 mode = find_mode(r, r->code);
    if (mode < 0) return NEED_MODE;
    r->mode = mode;
    const int failed = rhs(r, r->t, r->x, r->K[0]);
    for (i64 i = 0; i < r->n + 2; i++) zero += 0 * r->K[0][i];
    if (failed || zero != 0) return conclude(r, NON_FINITE);
    if (r->k) {
        measure(r, mode, r->code, r->sample[0], r->noise);
        for (i64 j = 0; j < r->k; j++) {
            /* The slip of a switch that starts to slip is zero, but for rounding (gathered over
             * a whole stick). What was settled holds even where rounding says otherwise. */
            const double g = r->sample[0][j], off = r->code[j] && r->fresh[j] ? fabs(g) : -g;
            r->noise[j] = larger(r->noise[j], 1.1 * off);
            r->armed[j] = r->sample[0][j] > r->noise[j];
        }
    }
    if (!r->keep_step) {
        first_step(r);
        r->log_error = log(1e-4);
    }
    r->keep_step = 0;
    r->bad = r->shrinks = r->halvings = r->after_rejection = 0;
    r->phase = STEP;
    return CONTINUE;
}

/* Proposal for the step after one of length h with error `error`. */
static void control(Run *r, double h, double error, int clipped)
{
    const double log_error = log(larger(error, DBL_MIN));
    const double slowed = exp((0.2 - 0.75 * BETA) * log_error - BETA * r->log_error);
    const double factor = larger(1 / FAC_MAX, smaller(1 / FAC_MIN, slowed / SAFETY));
    double next = h / factor;
    if (r->after_rejection) next = smaller(next, h);
    else if (clipped) next = larger(next, r->h);
    r->h = next;
    r->log_error = larger(log_error, log(1e-4));
    r->after_rejection = 0;
}

/* Shorter steps until the model is finite again; gives up where no step is. */
static i64 step_was_bad(Run *r, double h)
{
    r->rejected++;
    r->after_rejection = 1;
    r->h = 0.25 * h;
    return ++r->bad > MAX_BAD ? conclude(r, NON_FINITE) : CONTINUE;
}

static double next_stop(const Run *r)
{
    return r->knot + 1 < r->n_knots ? smaller(r->knots[r->knot + 1], r->t_end) : r->t_end;
}

static i64 step(Run *r)
{
    const double stop = next_stop(r);
    if (r->t >= r->t_end) return conclude(r, FINISHED);
    if (r->t >= stop) {
        r->phase = KNOT;
        return CONTINUE;
    }
    if (r->steps + r->rejected >= r->max_steps) return conclude(r, STEP_LIMIT);

    double h = smaller(r->h, r->max_step);
    const int clipped = r->t + 1.01 * h >= stop;
    if (clipped) h = stop - r->t;
    else if (!(h > 10 * ulp(r->t))) return conclude(r, r->bad ? NON_FINITE : STEP_UNDERFLOW);

    if (stages(r, h) || last_stage(r, h)) return step_was_bad(r, h);
    const double error = error_norm(r, h);
    if (!(error <= 1)) {
        r->rejected++;
        r->after_rejection = 1;
        r->h = h / smaller(1 / FAC_MIN, pow(error, 0.2) / SAFETY);
        return CONTINUE;
    }
    for (i64 i = 0; i < r->n; i++)
        if (fabs(r->x_new[i]) > r->bound) return conclude(r, DIVERGED);

    r->h_used = h;
    r->dense_ready = 0;
    r->event_pending = 0;
    if (r->k) {
        const int found = search(r, h);
        if (found == RETRY) {
            r->rejected++;
            r->after_rejection = 1;
            return r->bad > MAX_BAD ? conclude(r, NON_FINITE) : CONTINUE;
        }
        r->event_pending = found == EVENT;
    }
    r->t_new = clipped && r->h_used == h ? stop : r->t + r->h_used;
    control(r, h, error, clipped);
    r->phase = EMIT;
    return CONTINUE;
}

static void swap(double **a, double **b)
{
    double *kept = *a;
    *a = *b;
    *b = kept;
}

/* The end of the step becomes the present point. */
static void commit(Run *r)
{
    const i64 n = r->n;
    int all_armed = 1;
    swap(&r->x, &r->x_new);
    swap(&r->K[0], &r->K[6]);
    swap(&r->sample[0], &r->sample[4]);
    r->t = r->t_new;
    r->steps++;
    r->bad = r->halvings = 0;
    r->energy = larger(r->energy, fabs(r->energy0 + r->x[n] - r->x[n + 1]));
    const double amplitude = 1e-7 * sqrt(2 * r->energy);
    for (i64 i = 0; i < n; i++)
        r->floor[i] = larger(r->floor[i], larger(1e-3 * fabs(r->x[i]), r->weights[i] * amplitude));
    for (i64 j = 0; j < r->k; j++) all_armed &= r->armed[j];
    if (all_armed) r->shrinks = r->futile = 0;
}

/* Output rows of the step just taken, then the step itself. */
static i64 emit(Run *r)
{
    if (r->t_eval) {
        while (r->next_eval < r->n_eval && r->t_eval[r->next_eval] < r->t_new) {
            if (row_missing(r)) return ROWS_FULL;
            if (!r->dense_ready) make_dense(r, r->h_used);
            put_row(r, r->t_eval[r->next_eval++], NULL);
        }
    } else {
        if (row_missing(r)) return ROWS_FULL;
        put_row(r, r->t_new, r->x_new);
    }
    commit(r);
    r->unresolved = r->event_pending;
    r->phase = r->event_pending ? SETTLE : STEP;
    return CONTINUE;
}

/* Into the next interval of the input table; only a jump needs more than that. */
static i64 cross_knot(Run *r)
{
    const i64 m = r->m, i = ++r->knot;
    int jump = 0;
    for (i64 c = 0; c < m; c++)
        if (!r->hold[c] && i > 0) jump |= r->values[i * m + c] != r->values[(i - 1) * m + c];
    r->keep_step = jump;
    r->phase = jump ? CLASSIFY : STEP;
    return CONTINUE;
}

static i64 finish(Run *r)
{
    while (r->t_eval && r->next_eval < r->n_eval && r->t_eval[r->next_eval] <= r->t) {
        if (row_missing(r)) return ROWS_FULL;
        put_row(r, r->t_eval[r->next_eval++], r->x);
    }
    return r->outcome;
}

i64 halfarrow_advance(Run *r)
{
    static i64 (*const PHASES[])(Run *) = {
        begin, classify, restart, step, emit, settle, cross_knot, finish,
    };
    const double entered = seconds();
    for (i64 turn = 1;; turn++) {
        i64 status = PHASES[r->phase](r);
        if (status == CONTINUE && turn % 64 == 0 && seconds() - entered > r->slice) status = PAUSED;
        if (status != CONTINUE) {
            memcpy(r->x_end, r->x, (size_t)(r->n + 2) * sizeof(double));
            return status;
        }
    }
}
