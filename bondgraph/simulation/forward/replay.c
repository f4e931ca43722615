/*
 * Sensitivities of a run of driver.c: its steps are made once more, with their derivatives.
 *
 * Steps keep the lengths that they had, so what comes out is the derivative of the very map that
 * the run computed. With S = dx/dtheta and P = dp/dtheta, the slope of S is f_x S + f_p P; the
 * Jacobians come from tangent.c as the entries of sparse matrices, and q columns go through each
 * entry at a time.
 *
 * replay.py is the same algorithm in Python and gives the same bits: change both together.
 */
#include <float.h>
#include <math.h>
#include <string.h>

typedef long long i64;
typedef int (*Function)(double t, const double *x, const double *u, const double *p,
                        const double *s, double *out, i64 *iw, double *w);
typedef struct {
    i64 index, row, column;
} Entry;

typedef struct {
    unsigned long long stuck; /* bit j: switch j is stuck */
    Function rates;           /* f [n], then the entries of its Jacobian by x, p */
    Function surface;         /* g, its rate, sizes of the terms of both [k each], entries */
    i64 rates_count, surface_count;
    const Entry *rates_entries, *surface_entries;
} Mode;

enum { CONTINUE, DONE, NEED_MODE, PAUSED, PROJECT, GRAZING, AMBIGUOUS, NON_FINITE };
enum { ARRIVE, RESTART, TRAVEL };

/* Every field is 8 bytes wide; native.py mirrors the part above "private". */
typedef struct {
    i64 n, np, q, m, k, n_knots, n_steps, n_eval, n_modes, own_rows;
    double noise; /* share of a guard's terms that may be wrong in it */
    const double *parameters, *seeds, *record, *knots, *values, *shapes, *t_eval;
    const i64 *events; /* [3] each: switch, code before, code after */
    const signed char *jumps;
    const Mode *modes;
    i64 *iw;
    double *w;
    double *state;      /* [n + n q]: x, S */
    double *codes;      /* [k] */
    double *rows;       /* [n q] each */
    double *event_rows; /* [q] each */
    double *work;
    /* both ways */
    i64 until, step, events_done, row_count, culprit;
    unsigned long long wanted;
    /* private */
    i64 phase, knot, next_eval, row_due, begun, mode;
    double *next, *earlier, *u, *sums, *slope, *dense, *fresh, *stage, *out;
} Replay;

/* Events of one instant, in units of rounding; derivatives of one event; a rate of rounding. */
static const double TOGETHER = 1e3, AGREE = 1e-6, LEAST = 1e-12;

static double larger(double a, double b) { return a > b ? a : b; }

static i64 larger_of(i64 a, i64 b) { return a > b ? a : b; }

i64 replay_work_size(i64 n, i64 q, i64 m, i64 k, i64 entries)
{
    const i64 N = n + n * q;
    return 14 * N + 2 * k + m + n + m + k * q + larger_of(n, 4 * k) + entries + q + 8;
}

i64 replay_struct_size(void) { return (i64)sizeof(Replay); }

static double *take(double **from, i64 count)
{
    double *taken = *from;
    *from += count;
    return taken;
}

/* Called before the first turn, and again when a larger mode made room. */
void replay_lay_out(Replay *r)
{
    const i64 N = r->n + r->n * r->q;
    double *free = r->work;
    r->slope = take(&free, 7 * N);
    r->dense = take(&free, 5 * N);
    r->fresh = take(&free, N);
    r->stage = take(&free, N);
    r->next = take(&free, r->k + 1);
    r->earlier = take(&free, r->k + 1);
    r->sums = take(&free, r->k * r->q);
    r->u = take(&free, r->m + r->n + r->m + 1);
    r->out = free;
}

static void inputs(Replay *r, double t)
{
    const i64 m = r->m, i = r->knot < 0 ? 0 : r->knot;
    const int inside = r->knot >= 0 && i + 1 < r->n_knots;
    if (m == 0) return;
    const double s = t - r->knots[i];
    for (i64 c = 0; c < m; c++) {
        const double *shape = r->shapes + i * 3 * m + c;
        const double slope = inside ? shape[0] : 0;
        const double bend = inside ? shape[m] : 0, twist = inside ? shape[2 * m] : 0;
        r->u[c] = r->values[i * m + c] + s * (slope + s * (bend + s * twist));
        r->u[m + r->n + c] = slope + s * (2 * bend + s * (3 * twist));
    }
}

static const Mode *now(const Replay *r) { return r->modes + r->mode; }

/* The mode's place in the list, which only grows; -1 asks the caller for it. */
static i64 find_mode(Replay *r, const double *codes)
{
    unsigned long long stuck = 0;
    for (i64 j = 0; j < r->k; j++)
        if (codes[j] == 0) stuck |= 1ULL << j;
    for (i64 i = 0; i < r->n_modes; i++)
        if (r->modes[i].stuck == stuck) return i;
    r->wanted = stuck;
    return -1;
}

/*
 * Sums of entries times columns of S and P, for `width` columns from `c` on: a constant, so that the
 * sum of a row stays in registers. Entries come row by row.
 */
static inline __attribute__((always_inline)) void
spread_block(const i64 width, i64 c, const Replay *r, const Entry *entries, i64 count,
             const double *values, const double *S, double *restrict into)
{
    const i64 n = r->n, q = r->q;
    for (i64 e = 0; e < count;) {
        const i64 row = entries[e].row;
        double sum[8] = {0};
        do {
            const i64 column = entries[e].column;
            const double a = values[entries[e].index];
            const double *start = column < n ? S + column * q : r->seeds + (column - n) * q;
            const double *restrict from = start + c;
            for (i64 i = 0; i < width; i++) sum[i] += a * from[i];
        } while (++e < count && entries[e].row == row);
        for (i64 i = 0; i < width; i++) into[row * q + c + i] = sum[i];
    }
}

static void spread(const Replay *r, const Entry *entries, i64 count, const double *values,
                   const double *S, double *restrict into)
{
    i64 c = 0;
    for (; c + 8 <= r->q; c += 8) spread_block(8, c, r, entries, count, values, S, into);
    for (; c + 4 <= r->q; c += 4) spread_block(4, c, r, entries, count, values, S, into);
    for (; c < r->q; c++) spread_block(1, c, r, entries, count, values, S, into);
}

/* Slopes of x and S. */
static void rates(Replay *r, double t, const double *at, double *restrict slope)
{
    const i64 n = r->n;
    inputs(r, t);
    now(r)->rates(t, at, r->u, r->parameters, r->codes, r->out, r->iw, r->w);
    memcpy(slope, r->out, (size_t)n * sizeof(double));
    memset(slope + n, 0, (size_t)(n * r->q) * sizeof(double));
    spread(r, now(r)->rates_entries, now(r)->rates_count, r->out + n, at + n, slope + n);
}

/* Dormand and Prince's stages; each sum ends with the newest slope, as in kernel.c. */
static void stages(Replay *r, double t, double h)
{
    const i64 N = r->n + r->n * r->q;
    const double *restrict x = r->state;
    double *restrict y = r->stage, *restrict x_new = r->fresh;
    double *restrict k1 = r->slope, *restrict k2 = k1 + N, *restrict k3 = k2 + N;
    double *restrict k4 = k3 + N, *restrict k5 = k4 + N, *restrict k6 = k5 + N;

    for (i64 i = 0; i < N; i++) y[i] = x[i] + h * (1.0 / 5.0) * k1[i];
    rates(r, t + h * (1.0 / 5.0), y, k2);
    for (i64 i = 0; i < N; i++)
        y[i] = x[i] + h * (3.0 / 40.0 * k1[i]) + h * (9.0 / 40.0) * k2[i];
    rates(r, t + h * (3.0 / 10.0), y, k3);
    for (i64 i = 0; i < N; i++)
        y[i] = x[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i]) + h * (32.0 / 9.0) * k3[i];
    rates(r, t + h * (4.0 / 5.0), y, k4);
    for (i64 i = 0; i < N; i++)
        y[i] = x[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i]
                           + 64448.0 / 6561.0 * k3[i])
               - h * (212.0 / 729.0) * k4[i];
    rates(r, t + h * (8.0 / 9.0), y, k5);
    for (i64 i = 0; i < N; i++)
        y[i] = x[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i]
                           + 46732.0 / 5247.0 * k3[i] + 49.0 / 176.0 * k4[i])
               - h * (5103.0 / 18656.0) * k5[i];
    rates(r, t + h, y, k6);
    for (i64 i = 0; i < N; i++)
        x_new[i] = x[i] + h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i]
                               + 125.0 / 192.0 * k4[i] - 2187.0 / 6784.0 * k5[i])
                   + h * (11.0 / 84.0) * k6[i];
    rates(r, t + h, x_new, k6 + N);
}

/* Coefficients of the interpolant of S. */
static void interpolant(Replay *r, double h)
{
    const i64 N = r->n + r->n * r->q;
    const double *restrict x = r->state, *restrict x_new = r->fresh, *restrict k = r->slope;
    double *restrict d = r->dense;
    for (i64 i = r->n; i < N; i++) {
        const double rise = x_new[i] - x[i], bend = h * k[i] - rise;
        d[i] = x[i];
        d[i + N] = rise;
        d[i + 2 * N] = bend;
        d[i + 3 * N] = rise - h * k[i + 6 * N] - bend;
        d[i + 4 * N] = h * (-12715105075.0 / 11282082432.0 * k[i]
                            + 87487479700.0 / 32700410799.0 * k[i + 2 * N]
                            - 10690763975.0 / 1880347072.0 * k[i + 3 * N]
                            + 701980252875.0 / 199316789632.0 * k[i + 4 * N]
                            - 1453857185.0 / 822651844.0 * k[i + 5 * N]
                            + 69997945.0 / 29380423.0 * k[i + 6 * N]);
    }
}

static void put_inside(Replay *r, double part)
{
    const i64 n = r->n, N = n + n * r->q, count = n * r->q;
    const double *restrict d = r->dense + n, rest = 1 - part;
    double *restrict row = r->rows + r->row_count++ * count;
    for (i64 i = 0; i < count; i++)
        row[i] = d[i]
                 + part * (d[i + N] + rest * (d[i + 2 * N] + part * (d[i + 3 * N]
                                                                    + rest * d[i + 4 * N])));
}

static void put_row(Replay *r, const double *S)
{
    const i64 count = r->n * r->q;
    memcpy(r->rows + r->row_count++ * count, S, (size_t)count * sizeof(double));
}

/* Derivative of the time at which switch j's guard falls through zero, from what surface() gave. */
static void crossing(const Replay *r, i64 j, double *restrict dt)
{
    const i64 k = r->k, q = r->q;
    const double rate = r->out[k + j], *S = r->state + r->n;
    const Entry *entries = now(r)->surface_entries;
    i64 first = 0, last;
    while (first < now(r)->surface_count && entries[first].row < j) first++;
    for (last = first; last < now(r)->surface_count && entries[last].row == j; last++) continue;
    memset(r->sums + j * q, 0, (size_t)q * sizeof(double));
    spread(r, entries + first, last - first, r->out + 4 * k, S, r->sums);
    for (i64 c = 0; c < q; c++) dt[c] = -r->sums[j * q + c] / rate;
}

static void surface(Replay *r, double t, const double *x, const double *slope)
{
    inputs(r, t);
    memcpy(r->u + r->m, slope, (size_t)r->n * sizeof(double));
    now(r)->surface(t, x, r->u, r->parameters, r->codes, r->out, r->iw, r->w);
}

/*
 * Whether a guard falls at a rate that can be told. Where it is wrong by d it is met d/rate too
 * early or late, and there the rate is another: by d * turn / rate.
 */
static int falls(const Replay *r, i64 j, double h)
{
    const i64 k = r->k;
    const double rate = r->out[k + j], turn = fabs(rate - r->earlier[j]) / h;
    return rate < -LEAST * r->out[2 * k + j]
           && rate * rate > r->noise * r->out[3 * k + j] * turn;
}

/*
 * The event of switches `first` to `last` of the log: whichever of them fired gives the derivative
 * of its time; others changed with it. Leaves that in event_rows and the jump of S in the state.
 */
static i64 cross(Replay *r, const Mode *then, double t, i64 last)
{
    const i64 n = r->n, k = r->k, q = r->q, first = r->events_done;
    double *dt = r->event_rows + first * q, *other = r->out + 4 * k + now(r)->surface_count;
    const double *before = r->slope, *record = r->record + (r->step - 1) * (n + 3);
    double soonest = INFINITY;
    i64 fired = -1;
    surface(r, record[0], record + 3, r->slope + n + n * q); /* the next stage's will do */
    memcpy(r->earlier, r->out + k, (size_t)k * sizeof(double));
    surface(r, t, r->state, before);
    for (i64 e = first; e < last; e++) {
        const i64 j = r->events[3 * e];
        const double away = fabs(r->out[j] / r->out[k + j]);
        if (falls(r, j, record[1]) && away < soonest) {
            soonest = away;
            fired = j;
        }
    }
    r->culprit = r->events[3 * first];
    if (fired < 0) return GRAZING;
    crossing(r, fired, dt);
    for (i64 e = first; e < last; e++) {
        const i64 j = r->events[3 * e];
        const double away = fabs(r->out[j] / r->out[k + j]);
        if (j == fired || away > TOGETHER * DBL_EPSILON * larger(fabs(t), DBL_MIN)) continue;
        crossing(r, j, other);
        for (i64 c = 0; c < q; c++)
            if (!(fabs(other[c] - dt[c]) <= AGREE * larger(fabs(other[c]), fabs(dt[c])))) {
                r->culprit = j;
                return AMBIGUOUS;
            }
    }
    for (i64 e = first + 1; e < last; e++)
        memcpy(r->event_rows + e * q, dt, (size_t)q * sizeof(double));
    then->rates(t, r->state, r->u, r->parameters, r->next, r->out, r->iw, r->w);
    for (i64 i = 0; i < n; i++) {
        const double jump = before[i] - r->out[i];
        double *restrict S = r->state + n + i * q;
        for (i64 c = 0; c < q; c++) S[c] += jump * dt[c];
    }
    return CONTINUE;
}

/* The knot that is passed at time t; whether an input jumps there. */
static i64 next_knot(const Replay *r, double t, int *jump)
{
    i64 knot = r->knot;
    *jump = 0;
    while (knot + 1 < r->n_knots && r->knots[knot + 1] <= t) {
        knot++;
        *jump |= knot > 0 && r->begun && r->jumps[knot];
    }
    return knot;
}

/* At the start of a step, or at the end of all: events there, and jumps of inputs. */
static i64 arrive(Replay *r)
{
    const i64 n = r->n, k = r->k;
    const double *record = r->record + r->step * (n + 3), t = record[0];
    const i64 last = (i64)record[2];
    const int at_end = r->step == r->n_steps;
    int jump = 0, held = 0;
    const i64 knot = at_end ? r->knot : next_knot(r, t, &jump);
    if (r->begun && !jump && last == r->events_done) {
        r->knot = knot;
        r->phase = at_end ? RESTART : TRAVEL;
        return CONTINUE;
    }
    memcpy(r->next, r->codes, (size_t)k * sizeof(double));
    for (i64 e = r->events_done; e < last; e++)
        r->next[r->events[3 * e]] = (double)r->events[3 * e + 2];
    const i64 then = find_mode(r, r->next);
    if (then < 0) return NEED_MODE;
    const int by_guard = r->begun && !jump;
    if (by_guard) {
        const i64 status = cross(r, r->modes + then, t, last);
        if (status != CONTINUE) return status;
    } else {
        memset(r->event_rows + r->events_done * r->q, 0,
               (size_t)((last - r->events_done) * r->q) * sizeof(double));
        for (i64 j = 0; j < k; j++) held |= r->next[j] == 0 && (!r->begun || r->codes[j] != 0);
    }
    r->row_due = r->own_rows && (!r->begun || last > r->events_done);
    r->events_done = last;
    r->knot = knot;
    r->mode = then;
    r->begun = 1;
    memcpy(r->codes, r->next, (size_t)k * sizeof(double));
    r->phase = RESTART;
    return held ? PROJECT : CONTINUE;
}

static i64 restart(Replay *r)
{
    const double t = r->record[r->step * (r->n + 3)];
    if (r->row_due) put_row(r, r->state + r->n);
    r->row_due = 0;
    if (r->step < r->n_steps) {
        rates(r, t, r->state, r->slope);
        r->phase = TRAVEL;
        return CONTINUE;
    }
    while (!r->own_rows && r->next_eval < r->n_eval && r->t_eval[r->next_eval] <= t) {
        put_row(r, r->state + r->n);
        r->next_eval++;
    }
    return DONE;
}

static i64 travel(Replay *r)
{
    const i64 n = r->n, N = n + n * r->q;
    const double *record = r->record + r->step * (n + 3), t = record[0], h = record[1];
    const double t_new = record[n + 3];
    double zero = 0;
    int ready = 0;
    stages(r, t, h);
    for (i64 i = 0; i < N; i++) zero += 0 * r->fresh[i];
    if (zero != 0) return NON_FINITE;
    if (r->own_rows) put_row(r, r->fresh + n);
    while (!r->own_rows && r->next_eval < r->n_eval && r->t_eval[r->next_eval] < t_new) {
        if (!ready) interpolant(r, h);
        ready = 1;
        put_inside(r, (r->t_eval[r->next_eval++] - t) / h);
    }
    memcpy(r->state, r->fresh, (size_t)N * sizeof(double));
    memcpy(r->slope, r->slope + 6 * N, (size_t)N * sizeof(double));
    r->step++;
    r->phase = ARRIVE;
    return CONTINUE;
}

i64 replay_advance(Replay *r)
{
    static i64 (*const PHASES[])(Replay *) = {arrive, restart, travel};
    for (;;) {
        if (r->phase == TRAVEL && r->step >= r->until) return PAUSED;
        const i64 status = PHASES[r->phase](r);
        if (status != CONTINUE) return status;
    }
}
