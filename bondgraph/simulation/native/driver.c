/*
 * Event-driven integration of a model with dry-friction switches. Follows kernel.c, where the step
 * itself is; this file knows no model, and reaches a mode (a set of stuck switches) by `Mode`.
 *
 * stepper.py is the same algorithm, line by line, in Python, and gives the same bits: change both
 * together.
 *
 * halfarrow_advance() runs until it is done or needs its caller: an unknown mode, room for rows or
 * events, or a look at the clock. All state is in `Run`, so the caller serves the request and calls
 * again. Every phase checks what it needs before it changes anything, and so can be entered twice.
 */
#include <stddef.h>
#include <time.h>

/* What halfarrow_advance returns; from FINISHED on it is an outcome. */
enum { CONTINUE, NEED_MODE, ROWS_FULL, EVENTS_FULL, PAUSED,
       FINISHED, EVENT_LIMIT, CHATTERING, STEP_UNDERFLOW, STEP_LIMIT, NON_FINITE, DIVERGED };

enum { BEGIN, CLASSIFY, RESTART, STEP, EMIT, SETTLE, KNOT, CONCLUDE };

/* Every field is 8 bytes wide; native.py mirrors the part above "private". */
typedef struct {
    /* given by the caller */
    i64 n, m, k, n_knots, n_eval, n_modes, row_capacity, event_capacity, max_steps, max_events;
    double t_end, rtol, max_step, bound, energy0, slice;
    const double *x0, *parameters, *atol, *weights, *knots, *values, *shapes, *t_eval;
    const signed char *jumps; /* [n_knots] whether an input jumps there */
    const Mode *modes;
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
    i64 record_count, record_capacity;
    double *record; /* [n+3] each: t, length, events before, x, of every step; or NULL */
    /* private */
    i64 phase, outcome, mode, knot, next_eval, started, keep_step, unresolved, event_pending;
    i64 after_rejection, bad, shrinks, halvings, futile, settled, dense_ready, growths;
    double h, h_used, reached, t_new, t_begin, log_error, energy, h_first, last_error;
    double *x, *x_new, *slope, *stage, *s, *s_probe, *wobbled, *flat;
    double *probe, *noise, *probe_noise, *instants;
    signed char *next, *armed, *armed_low, *fired, *fresh;
    Step at; /* x, x_new and slope above are its own */
} Run;

/* ---------------------------------------------------------------------------- constants */

static const double FAC_MIN = 0.2, FAC_MAX = 5.0, SAFETY = 0.9, BETA = 0.04;
/* A first step may grow by so much where it is shorter than such a share of the run. */
static const double GROWTH = 32.0, SHORT = 1e-9;
static const double WOBBLE = 1.0 / 1048576.0; /* relative change of x that shows rounding of g */
#define WINDOW(k) (64 + 8 * (k))              /* events that must not share one instant */
enum { MAX_BAD = 20, MAX_SHRINKS = 6, MAX_HALVINGS = 6, MAX_GROWTHS = 8 };

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
    return 17 * (n + 2) + 3 * m + 2 * k + 16 * k + WINDOW(k) + 1;
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
    Step *at = &r->at;
    at->x = r->x = take(&free, N);
    at->x_new = r->x_new = take(&free, N);
    at->slopes = r->slope = take(&free, 7 * N);
    at->dense = take(&free, 5 * N);
    at->floor = take(&free, N);
    r->stage = take(&free, N);
    r->wobbled = take(&free, N);
    r->flat = take(&free, 3 * r->m);
    for (i64 c = 0; c < 3 * r->m; c++) r->flat[c] = 0;
    at->codes = r->s = take(&free, k + 1);
    r->s_probe = take(&free, k);
    at->sample = take(&free, 10 * k);
    r->probe = take(&free, 2 * k);
    r->noise = take(&free, 2 * k);
    r->probe_noise = take(&free, 2 * k);
    r->instants = take(&free, WINDOW(k));
    at->atol = r->atol;
    at->rtol = r->rtol;
    at->parameters = r->parameters;
    r->next = r->flags;
    r->armed = r->flags + k;
    r->armed_low = r->flags + 2 * k;
    r->fired = r->flags + 3 * k;
    r->fresh = r->flags + 4 * k;
}

/* ---------------------------------------------------------------------------- model */

/* Inputs in the interval after r->knot, which no step leaves: a cubic each, from its start on. */
static void set_inputs(Run *r)
{
    const i64 m = r->m, i = r->knot < 0 ? 0 : r->knot;
    const int inside = r->knot >= 0 && i + 1 < r->n_knots;
    if (m == 0) return;
    r->at.t_input = r->knots[i];
    r->at.u = r->values + i * m;
    r->at.u_slope = inside ? r->shapes + i * 3 * m : r->flat;
    r->at.u_bend = r->at.u_slope + m;
    r->at.u_twist = r->at.u_bend + m;
}

static const Mode *now(const Run *r) { return r->modes + r->mode; }

static int rhs(Run *r, double t, const double *x, double *out)
{
    r->evaluations++;
    return now(r)->rhs(&r->at, t, x, out);
}

static void guard(Run *r, double t, const double *x, double *out)
{
    now(r)->guard(&r->at, t, x, out);
}

static int advance(Run *r, double h)
{
    r->evaluations += 5;
    return now(r)->advance(&r->at, h);
}

static double finish(Run *r, double h)
{
    r->evaluations++;
    return now(r)->finish(&r->at, h);
}

static double *sample(const Run *r, int c) { return r->at.sample + 2 * r->k * c; }

/* The mode in which exactly the switches with code 0 stick; NULL asks the caller for it. */
static const Mode *find_mode(Run *r, const signed char *code)
{
    unsigned long long stuck = 0;
    for (i64 j = 0; j < r->k; j++)
        if (code[j] == 0) stuck |= 1ULL << j;
    for (i64 i = 0; i < r->n_modes; i++)
        if (r->modes[i].stuck == stuck) return r->modes + i;
    r->wanted = stuck;
    return NULL;
}

/*
 * Guards g, a of a mode at the present point, and how far rounding can move each: the change under
 * a small scattered change of the state, scaled down to the precision of a double. A state is
 * rounded like its largest value so far, for it is a sum of steps.
 */
static void measure(Run *r, const Mode *mode, const signed char *code, double *g, double *noise)
{
    for (i64 j = 0; j < r->k; j++) r->s_probe[j] = code[j];
    for (i64 i = 0; i < r->n; i++) {
        const double golden = (double)i * 0.6180339887498949;
        const double scatter = 0.5 + (golden - floor(golden));
        const double size = larger(fabs(r->x[i]), 1e3 * r->at.floor[i]);
        r->wobbled[i] = r->x[i] + WOBBLE * (i % 2 ? -scatter : scatter) * size;
    }
    r->at.codes = r->s_probe;
    mode->guard(&r->at, r->t, r->x, g);
    mode->guard(&r->at, r->t, r->wobbled, noise);
    r->at.codes = r->s;
    for (i64 j = 0; j < 2 * r->k; j++) {
        const double moved = fabs(noise[j] - g[j]);
        noise[j] = 64 * DBL_EPSILON * ((isfinite(moved) ? moved / WOBBLE : 0) + fabs(g[j]));
    }
}

/* ---------------------------------------------------------------------------- one step */

/* The first `count` components at the fraction `part` of the step. */
static void interpolate(const Run *r, double part, i64 count, double *restrict out)
{
    const i64 N = r->n + 2;
    const double *restrict d = r->at.dense;
    for (i64 i = 0; i < count; i++)
        out[i] = INTERPOLANT(d[i], d[i + N], d[i + 2 * N], d[i + 3 * N], d[i + 4 * N], part);
}

/*
 * First step after a start or an event: from the rate at which the slope turns over a small Euler
 * step, in the manner of Hairer, Norsett and Wanner but free of the unit of time.
 */
static void first_step(Run *r)
{
    const i64 n = r->n;
    double *reached = r->slope + (n + 2);
    const double remaining = r->t_end - r->t;
    double small = r->h > 0 ? 0.01 * r->h : 1e-6 * remaining;
    double size = 0, slope = 0;
    for (i64 i = 0; i < n; i++) {
        const double allowed = r->atol[i] + r->rtol * larger(fabs(r->x[i]), r->at.floor[i]);
        if (allowed > 0) {
            size = larger(size, fabs(r->x[i]) / allowed);
            slope = larger(slope, fabs(r->slope[i]) / allowed);
        }
    }
    if (slope > 0 && size > 0) small = smaller(small, 0.01 * size / slope);
    small = smaller(small, smaller(r->max_step, remaining));
    for (int tries = 0; tries < 12; tries++) {
        double turn = 0, zero = 0;
        slope = 0;
        for (i64 i = 0; i < n; i++) r->stage[i] = r->x[i] + small * r->slope[i];
        const int failed = rhs(r, r->t + small, r->stage, reached);
        for (i64 i = 0; i < n; i++) {
            const double reach = larger(fabs(r->x[i]), fabs(r->stage[i]));
            const double allowed = r->atol[i] + r->rtol * larger(reach, r->at.floor[i]);
            const double change = fabs(reached[i] - r->slope[i]);
            zero += 0 * reached[i];
            if (allowed > 0) {
                slope = larger(slope, fabs(r->slope[i]) / allowed);
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

/* ---------------------------------------------------------------------------- events in a step */

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

/* By a step of length tau, which is left in x_new; the switches below zero go to `fired`. */
static double level_true(Run *r, double tau)
{
    advance(r, tau);
    guard(r, r->t + tau, r->x_new, r->probe);
    r->reached = tau;
    const double level = lowest(r, r->probe);
    for (i64 j = 0; j < r->k && level < 0; j++)
        r->fired[j] = r->probe[j] + (r->armed_low[j] ? 0 : r->noise[j]) < 0;
    return level;
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
            if (sample(r, c)[j] > r->noise[j]) r->armed_low[j] = 1;
    }
}

/* Index of the first sample with a guard below zero, 5 if none; armed_low as just before it. */
static int first_below(Run *r)
{
    memcpy(r->armed_low, r->armed, (size_t)r->k);
    for (int c = 1; c < 5; c++) {
        if (lowest(r, sample(r, c)) < 0) return c;
        for (i64 j = 0; j < r->k; j++)
            if (sample(r, c)[j] > r->noise[j]) r->armed_low[j] = 1;
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
        curve.a[c] = sample(r, c)[r->k + j];
        curve.b[c] = curve.s != 0 ? 0 : sample(r, c)[j] + fabs(curve.a[c]);
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
    const double shift = turn > 0 ? tilt / turn : 0;
    *value = least - 0.5 * tilt * shift;
    return dz * (at - shift);
}

/*
 * A dip below zero between samples before `first`, all above it: predicted from the curves, tried
 * on the interpolant. Returns the fraction of the step and the sample before it; 0 if there is
 * none; -1 where a guard wobbles so much that a dip could hide. (The state's error control does not
 * see a force that depends on time alone while all is stuck.)
 */
static double find_dip(Run *r, int first, int *low)
{
    const i64 k = r->k;
    double found = 0;
    for (i64 j = 0; j < k; j++) {
        const Curve curve = make_curve(r, j);
        const double rough = roughness(&curve);
        double least = INFINITY, change = 0, value = 0;
        int from = 0;
        while (from < first && !r->armed[j] && !(sample(r, from)[j] > r->noise[j])) from++;
        for (int c = from; c < first; c++) least = smaller(least, sample(r, c)[j]);
        for (int c = 1; c < 5; c++)
            change = larger(change, fabs(sample(r, c)[k + j] - sample(r, c - 1)[k + j]));
        if (r->armed[j] && rough > 0.1 * change && rough > 0.1 * least
            && r->halvings < MAX_HALVINGS)
            return -1;
        if (found > 0 || least > 0.25 * bend(&curve)) continue;
        const double z = lowest_inside(&curve, from, first - 1, &value);
        if (z == 0 || value > 0.1 * rough) continue;
        arm_until(r, (int)z);
        if (level_dense(r, 0.25 * z * r->h_used) < 0) {
            *low = (int)z;
            found = 0.25 * z;
        }
    }
    return found;
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
    double f_low = level_dense(r, low), f_high = level_dense(r, high), reach = 1e-6 * h, slope = 0;
    if (f_low >= 0 && f_high < 0) {
        slope = (f_low - f_high) / (high - low);
        narrow(r, level_dense, &low, f_low, &high, f_high, 1e-9 * h);
    }

    /* the interpolant's event lies close to the true one: reach for its other side */
    double f = level_true(r, high);
    if (slope > 0) reach = larger(4 * tol, smaller(reach, 4 * fabs(f) / slope));
    if (f < 0) {
        for (f_low = -1; f_low < 0; reach *= 32) {
            f_high = f;
            low = larger(high - reach, 0);
            f_low = f = low > 0 ? level_true(r, low) : larger(lowest(r, sample(r, 0)), 0);
            if (f < 0) high = low;
        }
    } else {
        for (f_high = 0; f_high >= 0; reach *= 32) {
            if (high >= limit) {
                r->h_used = limit;
                return TRUNCATED;
            }
            low = high;
            f_low = f;
            high = smaller(low + reach, limit);
            f_high = f = level_true(r, high);
        }
    }
    narrow(r, level_true, &low, f_low, &high, f_high, tol);
    if (r->reached != low) advance(r, low);
    r->h_used = low;
    return EVENT;
}

/* Looks for events in the step of length h that ends in x_new. */
static int search(Run *r, double h)
{
    const i64 k = r->k;
    int low = 0;
    double part;
    r->h_used = h;
    now(r)->inspect(&r->at, h);

    const int first = first_below(r);
    if ((part = find_dip(r, first, &low)) < 0) {
        r->halvings++;
        r->h = 0.5 * h;
        return RETRY;
    }
    if (part > 0) {
        ; /* armed_low is as at the sample before the dip */
    } else if (first < 5) {
        arm_until(r, first - 1);
        low = first - 1;
        part = 0.25 * first;
        for (i64 j = 0; j < k; j++) {
            /* It fell without ever having risen. Either the step was too long for the little that
             * it should have risen, or the last decision was wrong: first try shorter steps. */
            const int suspicious = !r->armed_low[j] && sample(r, first)[j] < -r->noise[j];
            if (suspicious && r->shrinks < MAX_SHRINKS && h > 1000 * ulp(r->t)) {
                r->shrinks++;
                r->h = 0.125 * h;
                return RETRY;
            }
        }
    } else {
        arm_until(r, 4);
        memcpy(r->armed, r->armed_low, (size_t)k);
        return WHOLE;
    }

    const int found = locate(r, h, 0.25 * low * h, part * h);
    if (finish(r, r->h_used) < 0) {
        r->bad++;
        r->h = 0.25 * h;
        return RETRY;
    }
    now(r)->inspect(&r->at, r->h_used);
    for (i64 j = 0; j < k; j++)
        r->armed[j] = r->armed_low[j] || sample(r, 4)[j] > r->noise[j];
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
    r->at.t = r->t;
    memcpy(r->x, r->x0, (size_t)n * sizeof(double));
    r->x[n] = r->x[n + 1] = 0;
    r->t_begin = r->t;
    r->energy = fabs(r->energy0);
    for (i64 i = 0; i < n; i++) {
        zero += 0 * r->x[i];
        r->at.floor[i] = larger(1e-3 * fabs(r->x[i]), 1e-7 * r->weights[i] * sqrt(2 * r->energy));
    }
    r->knot = -1;
    while (r->knot + 1 < r->n_knots && r->knots[r->knot + 1] <= r->t) r->knot++;
    set_inputs(r);
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
        const Mode *mode = find_mode(r, r->next);
        i64 worst = -1;
        double most = 0;
        if (!mode) return NEED_MODE;
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
 * stick gives every slip. A slip of rounding size is a stick, if the breakaway force holds it; so
 * is one that stuck and that the jump does not move.
 */
static i64 classify(Run *r)
{
    const i64 k = r->k, knot = r->knot;
    if (k) {
        double *slip = r->probe + k, *before = sample(r, 1) + k;
        memset(r->next, 1, (size_t)k);
        const Mode *mode = find_mode(r, r->next);
        if (!mode) return NEED_MODE;
        if (r->started) {
            r->knot = knot - 1;
            set_inputs(r);
            measure(r, mode, r->next, sample(r, 1), r->probe_noise);
            r->knot = knot;
            set_inputs(r);
        }
        measure(r, mode, r->next, r->probe, r->probe_noise);
        for (i64 j = 0; j < k; j++) {
            if (!isfinite(slip[j])) return conclude(r, NON_FINITE);
            const int stuck = r->started && r->code[j] == 0;
            const double speed = fabs(stuck ? slip[j] - before[j] : slip[j]);
            r->fresh[j] = speed <= 64 * r->probe_noise[k + j];
            r->next[j] = (signed char)(r->fresh[j] ? 0 : sign(slip[j]));
        }
        const i64 status = release(r);
        if (status != CONTINUE) return status == NON_FINITE ? conclude(r, status) : status;
    }
    return adopt(r);
}

/* New codes at an event: what was overloaded slips, what came to rest is tried as a stick. */
static i64 settle(Run *r)
{
    const i64 k = r->k;
    const double *g = sample(r, 0), *force = g + k;
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
    const Mode *mode = find_mode(r, r->code);
    if (!mode) return NEED_MODE;
    r->mode = mode - r->modes;
    const int failed = rhs(r, r->t, r->x, r->slope);
    for (i64 i = 0; i < r->n + 2; i++) zero += 0 * r->slope[i];
    if (failed || zero != 0) return conclude(r, NON_FINITE);
    if (r->k) {
        measure(r, mode, r->code, sample(r, 0), r->noise);
        for (i64 j = 0; j < r->k; j++) {
            /* The slip of a switch that starts to slip is zero, but for rounding (gathered over
             * a whole stick). What was settled holds even where rounding says otherwise. */
            const double g = sample(r, 0)[j], off = r->code[j] && r->fresh[j] ? fabs(g) : -g;
            r->noise[j] = larger(r->noise[j], 1.1 * off);
            r->armed[j] = sample(r, 0)[j] > r->noise[j];
        }
    }
    r->growths = 0;
    if (!r->keep_step) {
        first_step(r);
        r->h = larger(r->h, 100 * ulp(r->t));
        r->growths = MAX_GROWTHS;
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

/* Whether a first step is so short that its error may be rounding. */
static int is_short(const Run *r, double h) { return h < SHORT * (r->t_end - r->t_begin); }

/*
 * The error with states measured by the energy at the end of the step, which was rest before: what
 * grows from zero with a high power of time has no small relative error in any step.
 */
static double forgiven(Run *r, double h)
{
    const i64 n = r->n;
    const double amplitude = 1e-7 * sqrt(2 * fabs(r->energy0 + r->x_new[n] - r->x_new[n + 1]));
    memcpy(r->wobbled, r->at.floor, (size_t)n * sizeof(double));
    for (i64 i = 0; i < n; i++)
        r->at.floor[i] = larger(r->at.floor[i], r->weights[i] * amplitude);
    r->evaluations--; /* slope 7 is made again, as it was */
    const double error = finish(r, h);
    memcpy(r->at.floor, r->wobbled, (size_t)n * sizeof(double));
    return error;
}

/*
 * The length to try after one whose error was too large. What begins to slip at no speed may be
 * given a first step so short that its error is rounding, of which a longer step has less: longer
 * ones are tried as long as that does not make it worse.
 */
static double after_error(Run *r, double h, double error)
{
    double shorter = h / smaller(1 / FAC_MIN, pow(error, 0.2) / SAFETY);
    const int first = r->growths == MAX_GROWTHS;
    if (r->growths && (first ? is_short(r, h) : error < 2 * r->last_error)) {
        if (first) r->h_first = shorter;
        r->growths--;
        r->last_error = error;
        return GROWTH * h;
    }
    if (r->growths && !first) shorter = r->h_first;
    r->growths = 0;
    return shorter;
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

    double error = advance(r, h) ? -1 : finish(r, h);
    if (!(error >= 0)) return step_was_bad(r, h);
    if (error > 1 && ((r->growths && is_short(r, h)) || r->energy == 0)) error = forgiven(r, h);
    if (error > 1) {
        r->rejected++;
        r->after_rejection = 1;
        r->h = after_error(r, h, error);
        return CONTINUE;
    }
    for (i64 i = 0; i < r->n; i++)
        if (fabs(r->x_new[i]) > r->bound) return conclude(r, DIVERGED);

    r->h_used = h;
    r->dense_ready = r->k > 0;
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

static int record_missing(const Run *r)
{
    return r->record && r->record_count >= r->record_capacity;
}

static void put_record(Run *r)
{
    double *record = r->record + r->record_count++ * (r->n + 3);
    record[0] = r->t;
    record[1] = r->h_used;
    record[2] = (double)r->event_count;
    memcpy(record + 3, r->x, (size_t)r->n * sizeof(double));
}

/* The end of the step becomes the present point. */
static void commit(Run *r)
{
    const i64 n = r->n;
    int all_armed = 1;
    if (r->record) put_record(r);
    memcpy(r->x, r->x_new, (size_t)(n + 2) * sizeof(double));
    memcpy(r->slope, r->slope + 6 * (n + 2), (size_t)(n + 2) * sizeof(double));
    memcpy(sample(r, 0), sample(r, 4), 2 * (size_t)r->k * sizeof(double));
    r->t = r->at.t = r->t_new;
    r->steps++;
    r->bad = r->halvings = r->growths = 0;
    r->energy = larger(r->energy, fabs(r->energy0 + r->x[n] - r->x[n + 1]));
    const double amplitude = 1e-7 * sqrt(2 * r->energy);
    for (i64 i = 0; i < n; i++) {
        const double size = larger(1e-3 * fabs(r->x[i]), r->weights[i] * amplitude);
        r->at.floor[i] = larger(r->at.floor[i], size);
    }
    for (i64 j = 0; j < r->k; j++) all_armed &= r->armed[j];
    if (all_armed) r->shrinks = r->futile = 0;
}

/* Output rows of the step just taken, then the step itself. */
static i64 emit(Run *r)
{
    if (record_missing(r)) return ROWS_FULL;
    if (r->t_eval) {
        while (r->next_eval < r->n_eval && r->t_eval[r->next_eval] < r->t_new) {
            if (row_missing(r)) return ROWS_FULL;
            if (!r->dense_ready) now(r)->inspect(&r->at, r->h_used);
            r->dense_ready = 1;
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
    const int jump = r->jumps[++r->knot];
    set_inputs(r);
    r->keep_step = jump;
    r->phase = jump ? CLASSIFY : STEP;
    return CONTINUE;
}

static i64 last_rows(Run *r)
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
        begin, classify, restart, step, emit, settle, cross_knot, last_rows,
    };
    const double entered = seconds();
    r->at.iw = r->iw; /* the caller may have moved them for a larger mode */
    r->at.w = r->w;
    for (i64 turn = 1;; turn++) {
        i64 status = PHASES[r->phase](r);
        if (status == CONTINUE && turn % 64 == 0 && seconds() - entered > r->slice) status = PAUSED;
        if (status != CONTINUE) {
            memcpy(r->x_end, r->x, (size_t)(r->n + 2) * sizeof(double));
            return status;
        }
    }
}
