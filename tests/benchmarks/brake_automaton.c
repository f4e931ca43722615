/* The bicycle brake as a hand-written event automaton: what the framework's speed is held against.
 *
 * Dormand-Prince 5(4) with a PI controller and its fourth-order dense output; three modes (stick,
 * slip+, slip-); events located on the dense output. Equations are those of Procedia Engineering 72
 * (2014) 471-476, friction is set-valued at zero slip, the pad force N0 (1 - exp(-t/tau)) is
 * analytic. Written to be as quick as this method allows: a slow baseline would flatter us.
 *
 *     gcc -O2 -march=native -o brake brake_automaton.c -lm && ./brake 200 0.5 1e-6 5001
 *     gcc -O2 -march=native -shared -fPIC -o libbrake.so brake_automaton.c -lm
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef double v4 __attribute__((vector_size(32)));
enum { W, V, TH, X };                          /* omega_r, V_c, theta_w, x_c */
enum { ROAD, BT, BF, FRICTION };               /* energies */
enum { OUT_OF_STEPS = -1, STEP_UNDERFLOW = -2, NOT_FINITE = -3 };
#define N_OUT_COLUMNS 5                        /* the four states and the pad force */
#define MAX_STEPS 10000000

/* Derived constants; held force = l[0..3] . y + l_constant. */
typedef struct {
    double r, k_t, b_t, k_f, b_f, J, m, inv_J, inv_m, w_t;
    double N0, inv_tau, mu_s, mu_k, excess, inv_vs;
    double inv_stuck, inv_r;
    double l[4], l_constant;
} Brake;

/* One step: time, length, exp(-t/tau) at both ends, states and slopes there, dense output. */
typedef struct {
    double t, h, decay, decay1;
    v4 y0, y1, k1, k7, c[5];
} Step;

typedef struct {
    const Brake *b;
    int mode;                                  /* 0 stick, +1, -1 slip */
    double t, decay, h, rtol, atol, h_max;
    float log_error;
    int armed, rejected;
    v4 y, k1;
} Run;

static inline double greater(double a, double b) { return a > b ? a : b; }
static inline double lesser(double a, double b) { return a < b ? a : b; }

static Brake derive(const double *p)
{
    const double k_f = p[0], k_w = p[1], f_f = p[2], f_w = p[3], r = p[4];
    const double zeta_f = p[6], zeta_w = p[7];
    const double V0 = p[8], mu_s = p[9], mu_k = p[10], v_s = p[11], F_k = p[12], tau = p[13];
    Brake b;
    b.r = r;
    b.inv_r = 1 / r;
    b.m = k_f / pow(2 * M_PI * f_f, 2);
    b.J = k_w / pow(2 * M_PI * f_w, 2) * r * r;
    b.k_f = k_f;
    b.k_t = k_w * r * r;
    b.b_f = 2 * zeta_f * sqrt(k_f * b.m);
    b.b_t = 2 * zeta_w * sqrt(b.k_t * b.J);
    b.w_t = V0 / r;
    b.inv_J = 1 / b.J;
    b.inv_m = 1 / b.m;
    b.N0 = F_k / mu_k;
    b.inv_tau = 1 / tau;
    b.mu_s = mu_s;
    b.mu_k = mu_k;
    b.excess = mu_s - mu_k;
    b.inv_vs = 1 / v_s;
    b.inv_stuck = 1 / (b.m + b.J / (r * r));
    const double a = r * b.inv_J, compliance = a * r + b.inv_m;
    b.l[W] = -a * b.b_t / compliance;
    b.l[V] = b.inv_m * b.b_f / compliance;
    b.l[TH] = a * b.k_t / compliance;
    b.l[X] = b.inv_m * b.k_f / compliance;
    b.l_constant = a * b.b_t * b.w_t / compliance;
    return b;
}

static inline double held_force(const Brake *b, v4 y)
{
    return b->l[W] * y[W] + b->l[V] * y[V] + b->l[TH] * y[TH] + b->l[X] * y[X] + b->l_constant;
}

static inline double held_force_rate(const Brake *b, v4 f)
{
    return b->l[W] * f[W] + b->l[V] * f[V] + b->l[TH] * f[TH] + b->l[X] * f[X];
}

static inline double slip_friction(const Brake *b, double sign, double slip, double normal)
{
    /* smooth past zero so that the step over an event is accurate; clamped against overflow */
    const double z = -sign * slip * b->inv_vs;
    return sign * normal * (b->mu_k + b->excess * exp(z < 3 ? z : 3));
}

static inline v4 slip_rates(const Brake *b, double sign, double normal, v4 y)
{
    const double wind = b->w_t - y[W];
    const double force = slip_friction(b, sign, b->r * y[W] - y[V], normal);
    return (v4){(b->k_t * y[TH] + b->b_t * wind - b->r * force) * b->inv_J,
                (force - b->k_f * y[X] - b->b_f * y[V]) * b->inv_m, wind, y[V]};
}

static inline v4 stick_rates(const Brake *b, v4 y)
{
    const double wind = b->w_t - y[W];
    const double torque = b->k_t * y[TH] + b->b_t * wind;
    const double a = (torque * b->inv_r - b->k_f * y[X] - b->b_f * y[V]) * b->inv_stuck;
    return (v4){a * b->inv_r, a, wind, y[V]};
}

static inline v4 rates(const Brake *b, int mode, double normal, v4 y)
{
    return mode ? slip_rates(b, mode, normal, y) : stick_rates(b, y);
}

static inline v4 greater_size(v4 a, v4 b)
{
    v4 c;
    for (int i = 0; i < 4; i++) {
        const double x = fabs(a[i]), y = fabs(b[i]);
        c[i] = x > y ? x : y;
    }
    return c;
}

/* Take one Dormand-Prince step of length h; returns the squared error norm. `mode` is a constant
 * at both calls, so each gets its own straight code. */
static inline __attribute__((always_inline)) double attempt(const Run *s, int mode, double h,
                                                            Step *o)
{
    const Brake *b = s->b;
    const v4 y = s->y, k1 = s->k1;
    double n2 = 0, n3 = 0, n4 = 0, n5 = 0, n6 = 0;
    if (!mode) {
        o->decay1 = s->decay * exp(-h * b->inv_tau);
    } else {
        /* the pad force at the stages from two exponentials, not five */
        const double e = exp(-0.1 * h * b->inv_tau), e2 = e * e, e4 = e2 * e2, e8 = e4 * e4;
        n2 = b->N0 * (1 - s->decay * e2);
        n3 = b->N0 * (1 - s->decay * e2 * e);
        n4 = b->N0 * (1 - s->decay * e8);
        n5 = b->N0 * (1 - s->decay * exp(-8.0 / 9 * h * b->inv_tau));
        o->decay1 = s->decay * (e8 * e2);
        n6 = b->N0 * (1 - o->decay1);
    }
    /* each sum ends with the newest slope: only its multiply-add waits for the stage before */
    const v4 k2 = rates(b, mode, n2, y + h * 0.2 * k1);
    const v4 k3 = rates(b, mode, n3, y + h * (3.0 / 40) * k1 + h * (9.0 / 40) * k2);
    const v4 k4 = rates(b, mode, n4,
                        y + h * (44.0 / 45) * k1 - h * (56.0 / 15) * k2 + h * (32.0 / 9) * k3);
    const v4 k5 = rates(b, mode, n5,
                        y + h * (19372.0 / 6561) * k1 - h * (25360.0 / 2187) * k2
                            + h * (64448.0 / 6561) * k3 - h * (212.0 / 729) * k4);
    const v4 k6 = rates(b, mode, n6,
                        y + h * (9017.0 / 3168) * k1 - h * (355.0 / 33) * k2
                            + h * (46732.0 / 5247) * k3 + h * (49.0 / 176) * k4
                            - h * (5103.0 / 18656) * k5);
    const v4 y1 = y + h * (35.0 / 384) * k1 + h * (500.0 / 1113) * k3 + h * (125.0 / 192) * k4
                  - h * (2187.0 / 6784) * k5 + h * (11.0 / 84) * k6;
    const v4 k7 = rates(b, mode, n6, y1);
    const v4 e = h * (71.0 / 57600 * k1 - 71.0 / 16695 * k3 + 71.0 / 1920 * k4
                      - 17253.0 / 339200 * k5 + 22.0 / 525 * k6 - 1.0 / 40 * k7);
    const v4 q = e / (s->atol + s->rtol * greater_size(y, y1)), q2 = q * q;

    const v4 rise = y1 - y, bend = h * k1 - rise;
    o->t = s->t;
    o->h = h;
    o->decay = s->decay;
    o->y0 = y;
    o->y1 = y1;
    o->k1 = k1;
    o->k7 = k7;
    o->c[0] = y;
    o->c[1] = rise;
    o->c[2] = bend;
    o->c[3] = rise - h * k7 - bend;
    o->c[4] = h * (-12715105075.0 / 11282082432 * k1 + 87487479700.0 / 32700410799 * k3
                   - 10690763975.0 / 1880347072 * k4 + 701980252875.0 / 199316789632 * k5
                   - 1453857185.0 / 822651844 * k6 + 69997945.0 / 29380423 * k7);
    return 0.25 * (q2[0] + q2[1] + q2[2] + q2[3]);
}

static inline v4 dense(const Step *o, double x)
{
    const double z = 1 - x;
    return o->c[0] + x * (o->c[1] + z * (o->c[2] + x * (o->c[3] + z * o->c[4])));
}

static inline double normal_at(const Brake *b, const Step *o, double x)
{
    return b->N0 * (1 - o->decay * exp(-x * o->h * b->inv_tau));
}

/* Guard of the current mode, positive within it: signed slip, or room left to the static limit on
 * the side (`side`) to which the held force pulls. */
static double guard(const Run *s, const Step *o, int side, double x)
{
    const v4 y = dense(o, x);
    if (s->mode)
        return s->mode * (s->b->r * y[W] - y[V]);
    return s->b->mu_s * normal_at(s->b, o, x) - side * held_force(s->b, y);
}

/* Zero of the guard between a (positive) and b (not), by the Illinois rule. */
static double locate(const Run *s, const Step *o, int side, double a, double b)
{
    double ga = guard(s, o, side, a), gb = guard(s, o, side, b);
    const double tiny = 1e-13 * fabs(ga - gb);
    for (int i = 0, last = 0; i < 100 && b - a > 1e-15; i++) {
        const double x = (a * gb - b * ga) / (gb - ga), g = guard(s, o, side, x);
        if (fabs(g) <= tiny)
            return x;
        if (g > 0) {
            a = x, ga = g;
            if (last > 0)
                gb *= 0.5;
            last = 1;
        } else {
            b = x, gb = g;
            if (last < 0)
                ga *= 0.5;
            last = -1;
        }
    }
    return b;
}

/* Where a cubic with these end values and slopes (per step) is least. */
static double cubic_minimum(double g0, double g1, double d0, double d1)
{
    const double a = 3 * (d0 + d1 - 2 * (g1 - g0)), b = 2 * (3 * (g1 - g0) - 2 * d0 - d1);
    const double q = sqrt(greater(0, b * b - 4 * a * d0));
    return -2 * d0 / (b + q);
}

/* Fraction of the step at which its mode ends; 2 if it does not, -1 if the step must be shorter. */
static double first_event(Run *s, const Step *o)
{
    const Brake *b = s->b;
    double g0, g1, d0, d1;
    int side = 1;
    if (s->mode) {
        g0 = s->mode * (b->r * o->y0[W] - o->y0[V]);
        g1 = s->mode * (b->r * o->y1[W] - o->y1[V]);
        d0 = o->h * s->mode * (b->r * o->k1[W] - o->k1[V]);
        d1 = o->h * s->mode * (b->r * o->k7[W] - o->k7[V]);
    } else {
        const double f1 = held_force(b, o->y1), limit = b->mu_s * b->N0;
        side = f1 < 0 ? -1 : 1;
        g0 = limit * (1 - o->decay) - side * held_force(b, o->y0);
        g1 = limit * (1 - o->decay1) - side * f1;
        d0 = o->h * (limit * b->inv_tau * o->decay - side * held_force_rate(b, o->k1));
        d1 = o->h * (limit * b->inv_tau * o->decay1 - side * held_force_rate(b, o->k7));
    }
    if (!s->armed) {
        /* the guard starts at zero, often with zero rate: its sign there is rounding */
        if (g1 > 0)
            return 2;
        for (int i = 1; i < 16; i++)
            if (guard(s, o, side, i / 16.0) > 0)
                return locate(s, o, side, i / 16.0, 1);
        return -1;
    }
    if (g1 <= 0)
        return locate(s, o, side, 0, 1);
    if (d0 < 0 && d1 > 0) {
        const double x = cubic_minimum(g0, g1, d0, d1);
        if (x > 0 && x < 1 && guard(s, o, side, x) < 0)
            return locate(s, o, side, 0, x);
    }
    return 2;
}

/* Work done in the first part x of a step: three-point Gauss on the dense output. */
static void add_energies(const Run *s, const Step *o, double x, double *energy)
{
    static const double node[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
    static const double weight[3] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
    const Brake *b = s->b;
    for (int i = 0; i < 3; i++) {
        const double at = x * node[i], dt = weight[i] * x * o->h;
        const v4 y = dense(o, at);
        const double wind = b->w_t - y[W], slip = b->r * y[W] - y[V];
        energy[ROAD] += dt * b->w_t * (b->k_t * y[TH] + b->b_t * wind);
        energy[BT] += dt * b->b_t * wind * wind;
        energy[BF] += dt * b->b_f * y[V] * y[V];
        if (s->mode)
            energy[FRICTION] += dt * slip * slip_friction(b, s->mode, slip, normal_at(b, o, at));
    }
}

/* Mode in which a brake without slip moves on. */
static int mode_without_slip(const Brake *b, v4 y, double normal)
{
    const double f = held_force(b, y);
    return fabs(f) <= b->mu_s * normal ? 0 : f > 0 ? 1 : -1;
}

/* Change mode at fraction x of a step. */
static void change_mode(Run *s, const Step *o, double x)
{
    const Brake *b = s->b;
    v4 y = dense(o, x);
    s->t = o->t + x * o->h;
    s->decay = o->decay * exp(-x * o->h * b->inv_tau);
    const double normal = b->N0 * (1 - s->decay);
    if (s->mode == 0)
        s->mode = held_force(b, y) > 0 ? 1 : -1;
    else
        s->mode = mode_without_slip(b, y, normal);
    y[W] = y[V] * b->inv_r;                    /* what the root finder left of the slip */
    s->y = y;
    s->k1 = rates(b, s->mode, normal, y);
    s->armed = s->mode == 0;
}

/* Next step length after squared error norm `error`: Hairer's PI controller. */
static double next_length(Run *s, double h, double error)
{
    /* single precision is plenty for a step length and shortens the wait for it */
    const float lg = logf(greater((float)error, 1e-20f));
    const float factor = 0.9f * expf(-0.085f * lg + 0.02f * s->log_error);
    s->log_error = greater(lg, -18.4f);
    const double next = h * lesser(greater(factor, 0.2f), s->rejected ? 1 : 10);
    s->rejected = 0;
    return lesser(next, s->h_max);
}

/* Run with everything: start may be NULL (steady rolling), energies may be NULL (not computed).
 * events holds max_events rows: time, mode entered (0, 1, -1). Returns the number of events (which
 * may exceed max_events) or a negative code. n_out >= 2 rows at equal distance from 0 to t_end. */
int brake_run_full(const double *params, const double *start, double t_end, double rtol,
                   double atol, int n_out, double *out, double *events, int max_events,
                   double *energies)
{
    const Brake b = derive(params);
    const double f_max = greater(params[2], params[3]), dt = t_end / (n_out - 1);
    const double out_decay = exp(-dt * b.inv_tau);
    double row_decay = 1;
    int row = 0, n_events = 0;
    Run s = {.b = &b, .rtol = rtol, .atol = atol, .h_max = 1 / (8 * f_max), .log_error = -18.4};
    Step o;

    s.y = start ? (v4){start[0], start[1], start[2], start[3]} : (v4){b.w_t, 0, 0, 0};
    s.decay = 1;
    const double slip = b.r * s.y[W] - s.y[V];
    s.mode = slip > 0 ? 1 : slip < 0 ? -1 : mode_without_slip(&b, s.y, 0);
    s.armed = slip != 0;
    s.k1 = rates(&b, s.mode, 0, s.y);
    s.h = 0.01 / f_max;
    if (energies)
        memset(energies, 0, 4 * sizeof *energies);

    for (int n = 0; n < MAX_STEPS; n++) {
        const int last = s.t + s.h >= t_end * (1 - 1e-14);
        const double h = last ? t_end - s.t : s.h;
        const double error = s.mode == 0   ? attempt(&s, 0, h, &o)
                             : s.mode == 1 ? attempt(&s, 1, h, &o)
                                           : attempt(&s, -1, h, &o);
        if (!(error <= 1)) {
            if (!isfinite(error))
                return NOT_FINITE;
            s.h = h * greater(0.2, 0.9 * expf(-0.1f * logf((float)error)));
            s.rejected = 1;
            if (s.h < 1e-14 * t_end)
                return STEP_UNDERFLOW;
            continue;
        }
        double x = first_event(&s, &o);
        if (x < 0) {
            if (h > 1e-12 * t_end) {
                s.h = 0.1 * h;
                continue;
            }
            x = 2;                             /* too short a step to tell rounding from motion */
        }
        const double until = x <= 1 ? s.t + x * h : s.t + h;
        const double inv_h = 1 / h, edge = last && x > 1 ? t_end * 2 : until;
        for (; row < n_out && row * dt <= edge; row++, row_decay *= out_decay) {
            const v4 y = dense(&o, (row * dt - s.t) * inv_h);
            memcpy(out + N_OUT_COLUMNS * row, &y, sizeof y);
            out[N_OUT_COLUMNS * row + 4] = b.N0 * (1 - row_decay);
        }
        if (energies)
            add_energies(&s, &o, x <= 1 ? x : 1, energies);
        s.h = next_length(&s, h, error);
        if (x <= 1) {
            change_mode(&s, &o, x);
            s.h *= 0.1;                        /* the slope of friction is new: feel the way */
            if (n_events < max_events) {
                events[2 * n_events] = s.t;
                events[2 * n_events + 1] = s.mode;
            }
            n_events++;
            continue;
        }
        if (last)
            return n_events;
        s.armed = 1;
        s.t += h;
        s.decay = o.decay1;
        s.y = o.y1;
        s.k1 = o.k7;
    }
    return OUT_OF_STEPS;
}

/* The plain entry: default start, absolute tolerance a thousandth of the relative, no energies. */
int brake_run(const double *params, double t_end, double rtol, int n_out, double *out,
              double *events, int max_events)
{
    return brake_run_full(params, NULL, t_end, rtol, 1e-3 * rtol, n_out, out, events, max_events,
                          NULL);
}

/* A loop over parameter sets of 14: states at the end, and how often it stuck (-1: gave up). */
int brake_sweep(const double *params, int count, double t_end, double rtol, double *final,
                int *sticks)
{
    enum { ROOM = 4096 };
    double out[2 * N_OUT_COLUMNS], events[2 * ROOM];
    for (int i = 0; i < count; i++) {
        const int n = brake_run(params + 14 * i, t_end, rtol, 2, out, events, ROOM);
        sticks[i] = n < 0 || n > ROOM ? -1 : 0;
        for (int k = 0; k < n && n <= ROOM; k++)
            sticks[i] += events[2 * k + 1] == 0;
        memcpy(final + 4 * i, out + N_OUT_COLUMNS, 4 * sizeof *final);
    }
    return count;
}

#ifndef NO_MAIN
static double cpu_seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

int main(int argc, char **argv)
{
    static const struct { const char *name; double mu_s, v_s, tau; } sets[] = {
        {"fig6", 0.42, 0.05, 0.03}, {"fig7", 0.42, 0.05, 0.02},
        {"fig8", 0.50, 0.05, 0.02}, {"fig9", 0.50, 0.20, 0.06}};
    enum { MAX_EVENTS = 1000 };
    const int repeats = argc > 1 ? atoi(argv[1]) : 100;
    const double t_end = argc > 2 ? atof(argv[2]) : 0.5, rtol = argc > 3 ? atof(argv[3]) : 1e-6;
    const int n_out = argc > 4 ? atoi(argv[4]) : 5001;
    double *out = malloc(sizeof *out * N_OUT_COLUMNS * n_out), events[2 * MAX_EVENTS];

    for (int i = 0; i < 4; i++) {
        const double p[14] = {350e3, 90e3, 300, 200, 0.08, 0.33, 0.05, 0.05,
                              0.9, sets[i].mu_s, 0.4, sets[i].v_s, 900, sets[i].tau};
        int n = 0, sticks = 0;
        const double start = cpu_seconds();
        for (int k = 0; k < repeats; k++)
            n = brake_run(p, t_end, rtol, n_out, out, events, MAX_EVENTS);
        const double each = (cpu_seconds() - start) / repeats;
        for (int k = 0; k < n && k < MAX_EVENTS; k++)
            sticks += events[2 * k + 1] == 0;
        const double *y = out + N_OUT_COLUMNS * (n_out - 1);
        printf("%s %.6f ms a run, %d sticks, final %.12g %.12g %.12g %.12g\n", sets[i].name,
               1e3 * each, sticks, y[0], y[1], y[2], y[3]);
    }
    free(out);
    return 0;
}
#endif
