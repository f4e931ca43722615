/* Eigenvalues of many small real matrices: balanced, brought to Hessenberg form by reflections,
   then by Francis' double shifts, as in Golub and Van Loan, Matrix Computations, ch. 7. LAPACK's
   own care for large matrices costs more than the work on small ones. */

#include <math.h>

#define A(i, j) a[(i) * n + (j)]
#define MOST_SWEEPS 60
#define EPS 2.220446049250313e-16

/* Scale rows and columns by powers of two until they are of like size. */
static void balance(long n, double *a) {
    for (int again = 1; again;) {
        again = 0;
        for (long i = 0; i < n; i++) {
            double column = 0, row = 0, factor = 1;
            for (long j = 0; j < n; j++) {
                if (j == i) continue;
                column += fabs(A(j, i));
                row += fabs(A(i, j));
            }
            if (!(column > 0 && row > 0 && column < HUGE_VAL && row < HUGE_VAL)) continue;
            double sum = column + row, scaled = column;
            while (scaled < row / 2) factor *= 2, scaled *= 4;
            while (scaled >= row * 2) factor /= 2, scaled /= 4;
            if (factor == 1 || (scaled + row) / factor >= 0.95 * sum) continue;
            again = 1;
            for (long j = 0; j < n; j++) A(i, j) /= factor;
            for (long j = 0; j < n; j++) A(j, i) *= factor;
        }
    }
}

/* The reflection I - tau v v', v[0] = 1, that takes x to a multiple of its first unit vector. */
static double reflection(long size, const double *x, double *v) {
    double largest = 0, square = 0;
    for (long i = 0; i < size; i++) largest = fmax(largest, fabs(x[i]));
    if (largest == 0) return 0;
    for (long i = 0; i < size; i++) square += (x[i] / largest) * (x[i] / largest);
    double first = x[0] / largest, norm = copysign(sqrt(square), first), tail = 0;
    v[0] = 1;
    for (long i = 1; i < size; i++) {
        v[i] = x[i] / largest / (first + norm);
        tail += fabs(v[i]);
    }
    return tail == 0 ? 0 : (first + norm) / norm;
}

/* Reflect rows k.. in columns from..to, then columns k.. in rows up..down. */
static void reflect(long n, double *a, long k, long size, const double *v, double tau,
                    long from, long to, long up, long down) {
    for (long j = from; j <= to; j++) {
        double sum = 0;
        for (long i = 0; i < size; i++) sum += v[i] * A(k + i, j);
        for (long i = 0; i < size; i++) A(k + i, j) -= tau * sum * v[i];
    }
    for (long j = up; j <= down; j++) {
        double sum = 0;
        for (long i = 0; i < size; i++) sum += v[i] * A(j, k + i);
        for (long i = 0; i < size; i++) A(j, k + i) -= tau * sum * v[i];
    }
}

static void hessenberg(long n, double *a, double *x, double *v) {
    for (long k = 0; k + 2 < n; k++) {
        long size = n - k - 1;
        for (long i = 0; i < size; i++) x[i] = A(k + 1 + i, k);
        double tau = reflection(size, x, v);
        if (tau == 0) continue;
        reflect(n, a, k + 1, size, v, tau, k, n - 1, 0, n - 1);
        for (long i = k + 2; i < n; i++) A(i, k) = 0;
    }
}

static void pair(double a, double b, double c, double d, double *re, double *im) {
    double half = (a - d) / 2, square = half * half + b * c;
    if (square < 0) {
        re[0] = re[1] = d + half;
        im[0] = sqrt(-square);
        im[1] = -im[0];
        return;
    }
    double far = half + copysign(sqrt(square), half);
    re[0] = d + far;
    re[1] = far == 0 ? re[0] : d - b * c / far;
    im[0] = im[1] = 0;
}

/* One sweep of two shifts with sum s and product t through the window low..high. */
static void sweep(long n, double *a, long low, long high, double s, double t) {
    double x[3], v[3];
    double h00 = A(low, low), h01 = A(low, low + 1), h10 = A(low + 1, low);
    x[0] = h00 * (h00 - s) + t + h01 * h10;
    x[1] = h10 * (h00 + A(low + 1, low + 1) - s);
    x[2] = h10 * A(low + 2, low + 1);
    for (long k = low; k < high; k++) {
        long size = k + 2 <= high ? 3 : 2;
        double tau = reflection(size, x, v);
        if (tau != 0)
            reflect(n, a, k, size, v, tau, k > low ? k - 1 : low, high, low,
                    k + 3 < high ? k + 3 : high);
        if (k > low)
            for (long i = 1; i < size; i++) A(k + i, k - 1) = 0;
        x[0] = A(k + 1, k);
        if (k + 2 <= high) x[1] = A(k + 2, k);
        if (k + 3 <= high) x[2] = A(k + 3, k);
    }
}

static int one(long n, double *a, double *re, double *im) {
    double norm = 0;
    for (long i = 0; i < n; i++)
        for (long j = i ? i - 1 : 0; j < n; j++) norm = fmax(norm, fabs(A(i, j)));
    long high = n - 1;
    int sweeps = 0;
    while (high >= 0) {
        long low = high;
        for (; low > 0; low--) {
            double size = fabs(A(low - 1, low - 1)) + fabs(A(low, low));
            if (fabs(A(low, low - 1)) <= EPS * (size > 0 ? size : norm)) {
                A(low, low - 1) = 0;
                break;
            }
        }
        if (low == high) {
            re[high] = A(high, high);
            im[high] = 0;
        } else if (low == high - 1) {
            pair(A(low, low), A(low, high), A(high, low), A(high, high), re + low, im + low);
        } else {
            if (++sweeps > MOST_SWEEPS) return 0;
            double s = A(high, high) + A(high - 1, high - 1);
            double t = A(high, high) * A(high - 1, high - 1) - A(high, high - 1) * A(high - 1, high);
            if (sweeps % 10 == 0) { /* a shift of another kind, where these go round in circles */
                double size = fabs(A(high, high - 1)) + fabs(A(high - 1, high - 2));
                s = 1.5 * size;
                t = size * size;
            }
            sweep(n, a, low, high, s, t);
            continue;
        }
        high = low - 1;
        sweeps = 0;
    }
    return 1;
}

/* a: m matrices of n rows, overwritten; re, im: m rows of n. Returns the number of rows without
   a result, which are left nan. */
long halfarrow_eigenvalues(long m, long n, double *a, double *re, double *im) {
    long failed = 0;
    double x[n], v[n];
    for (long i = 0; i < m; i++, a += n * n, re += n, im += n) {
        balance(n, a);
        hessenberg(n, a, x, v);
        if (one(n, a, re, im)) continue;
        failed++;
        for (long j = 0; j < n; j++) re[j] = im[j] = NAN;
    }
    return failed;
}
