/*
 * Many runs of one model, one after the other, without leaving C: for sweeps that ask only how
 * runs end. Follows driver.c, whose phases do the work.
 *
 * halfarrow_batch() returns what halfarrow_advance() may ask for (a mode, room for events, a look
 * at the clock) or BATCH_DONE; call it again with the same two structs to go on.
 */

/* Every field is 8 bytes wide; batch.py mirrors it. */
typedef struct {
    i64 count, n_parameters;
    double t_begin, seconds_each;
    const double *parameters; /* [count][n_parameters] */
    const double *x0, *weights; /* [count][n] */
    const double *energy0;    /* [count] */
    const double *inputs;     /* [count][m]; NULL where all runs share theirs */
    double *t_end;            /* [count] */
    double *x_end;            /* [count][n+2] */
    signed char *codes;       /* [count][k] */
    i64 *entered;             /* [count][k][3]: events into code 0, +1, -1 */
    i64 *steps;               /* [count][3]: steps, rejected, evaluations */
    i64 *outcomes;            /* [count]: as halfarrow_advance() returns them; PAUSED: out of time */
    /* both ways */
    i64 at, begun;
    double started;
} Batch;

enum { BATCH_DONE = CONTINUE };

static void begin_point(Run *r, Batch *b)
{
    const i64 i = b->at;
    memset((char *)r + offsetof(Run, phase), 0, sizeof(Run) - offsetof(Run, phase));
    r->t = b->t_begin;
    r->parameters = b->parameters + i * b->n_parameters;
    r->x0 = b->x0 + i * r->n;
    r->weights = b->weights + i * r->n;
    r->energy0 = b->energy0[i];
    if (b->inputs) r->values = b->inputs + i * r->m;
    r->row_count = r->event_count = r->steps = r->rejected = r->evaluations = 0;
    memset(r->code, 0, (size_t)r->k);
    b->started = seconds();
    b->begun = 1;
}

static void end_point(Run *r, Batch *b, i64 outcome)
{
    const i64 i = b->at, n = r->n, k = r->k;
    i64 *entered = b->entered + 3 * k * i;
    b->outcomes[i] = outcome;
    b->t_end[i] = r->t;
    memcpy(b->x_end + (n + 2) * i, r->x, (size_t)(n + 2) * sizeof(double));
    memcpy(b->codes + k * i, r->code, (size_t)k);
    memset(entered, 0, 3 * (size_t)k * sizeof(i64));
    for (i64 e = 0; e < r->event_count; e++) {
        const i64 *codes = r->event_codes + 3 * e;
        entered[3 * codes[0] + (codes[2] == 0 ? 0 : codes[2] > 0 ? 1 : 2)]++;
    }
    b->steps[3 * i] = r->steps;
    b->steps[3 * i + 1] = r->rejected;
    b->steps[3 * i + 2] = r->evaluations;
    b->at++;
    b->begun = 0;
}

i64 halfarrow_batch(Run *r, Batch *b)
{
    const double entered = seconds();
    while (b->at < b->count) {
        if (!b->begun) begin_point(r, b);
        const i64 status = halfarrow_advance(r);
        if (status >= FINISHED)
            end_point(r, b, status);
        else if (status != PAUSED)
            return status;
        else if (seconds() - b->started > b->seconds_each)
            end_point(r, b, PAUSED);
        if (seconds() - entered > r->slice) return PAUSED;
    }
    return BATCH_DONE;
}
