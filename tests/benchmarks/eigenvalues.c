/* Eigenvalues of many small real matrices, written by hand: the limit for eigenvalue maps.
 *
 * Householder reduction to Hessenberg form, then Francis's implicit double-shift QR without
 * vectors (Golub and Van Loan, Matrix Computations, 4th ed., algorithms 7.4.2, 7.5.1, 7.5.2).
 * Rows and columns are scaled by powers of two beforehand, for brakes mix radians with newtons.
 *
 *     gcc -O2 -march=native -shared -fPIC -o eigenvalues.so eigenvalues.c -lm
 */
#include <float.h>
#include <math.h>
#include <string.h>

#define MOST 16
#define AT(i, j) a[(i) * n + (j)]

/* Similarity by powers of two until no row and column differ by more than about a factor two. */
static void balance(int n, double *a)
{
    for (int again = 1; again;) {
        again = 0;
        for (int i = 0; i < n; i++) {
            double row = 0, column = 0;
            for (int j = 0; j < n; j++)
                if (j != i) row += fabs(AT(i, j)), column += fabs(AT(j, i));
            if (row == 0 || column == 0) continue;
            const int power = (int)lround(0.5 * log2(row / column));
            const double f = ldexp(1, power), g = ldexp(1, -power);
            if (power == 0 || column * f + row * g > 0.95 * (column + row)) continue;
            again = 1;
            for (int j = 0; j < n; j++) AT(j, i) *= f;
            for (int j = 0; j < n; j++) AT(i, j) *= g;
        }
    }
}

/* v and beta with (I - beta v v') x = (alpha, 0, ...)'; v[0] = 1. */
static double reflector(int m, const double *x, double *v)
{
    double rest = 0;
    for (int i = 1; i < m; i++) rest += x[i] * x[i];
    v[0] = 1;
    if (rest == 0) {
        for (int i = 1; i < m; i++) v[i] = 0;
        return 0;
    }
    const double size = sqrt(x[0] * x[0] + rest);
    const double head = x[0] <= 0 ? x[0] - size : -rest / (x[0] + size);
    for (int i = 1; i < m; i++) v[i] = x[i] / head;
    return 2 * head * head / (rest + head * head);
}

static void from_left(int n, double *a, int row, int m, const double *v, double beta, int from)
{
    for (int j = from; j < n; j++) {
        double sum = 0;
        for (int i = 0; i < m; i++) sum += v[i] * AT(row + i, j);
        sum *= beta;
        for (int i = 0; i < m; i++) AT(row + i, j) -= sum * v[i];
    }
}

static void from_right(int n, double *a, int column, int m, const double *v, double beta, int to)
{
    for (int i = 0; i < to; i++) {
        double sum = 0;
        for (int j = 0; j < m; j++) sum += AT(i, column + j) * v[j];
        sum *= beta;
        for (int j = 0; j < m; j++) AT(i, column + j) -= sum * v[j];
    }
}

static void hessenberg(int n, double *a)
{
    double x[MOST], v[MOST];
    for (int k = 0; k + 2 < n; k++) {
        const int m = n - k - 1;
        for (int i = 0; i < m; i++) x[i] = AT(k + 1 + i, k);
        const double beta = reflector(m, x, v);
        if (beta == 0) continue;
        from_left(n, a, k + 1, m, v, beta, k);
        from_right(n, a, k + 1, m, v, beta, n);
        for (int i = 1; i < m; i++) AT(k + 1 + i, k) = 0;
    }
}

/* One double step on the unreduced block of rows low to high. */
static void francis(int n, double *a, int low, int high, int exceptional)
{
    double s = AT(high - 1, high - 1) + AT(high, high), v[3];
    double t = AT(high - 1, high - 1) * AT(high, high) - AT(high - 1, high) * AT(high, high - 1);
    if (exceptional) {
        const double size = fabs(AT(high, high - 1)) + fabs(AT(high - 1, high - 2));
        s = 1.5 * size;
        t = size * size;
    }
    double x[3] = {
        AT(low, low) * AT(low, low) + AT(low, low + 1) * AT(low + 1, low) - s * AT(low, low) + t,
        AT(low + 1, low) * (AT(low, low) + AT(low + 1, low + 1) - s),
        AT(low + 1, low) * AT(low + 2, low + 1),
    };
    for (int k = low; k < high; k++) {
        const int m = k + 2 <= high ? 3 : 2;
        if (k > low)
            for (int i = 0; i < m; i++) x[i] = AT(k + i, k - 1);
        const double beta = reflector(m, x, v);
        if (beta != 0) {
            from_left(n, a, k, m, v, beta, k > low ? k - 1 : low);
            from_right(n, a, k, m, v, beta, k + 4 <= high + 1 ? k + 4 : high + 1);
        }
        if (k > low)
            for (int i = 1; i < m; i++) AT(k + i, k - 1) = 0;
    }
}

static void pair(double a, double b, double c, double d, double *w)
{
    const double half = 0.5 * (a - d), mean = 0.5 * (a + d), under = half * half + b * c;
    if (under < 0) {
        w[0] = w[2] = mean;
        w[1] = sqrt(-under);
        w[3] = -w[1];
        return;
    }
    const double far = mean + copysign(sqrt(under), mean);
    w[0] = far;
    w[2] = far != 0 ? (a * d - b * c) / far : 0;
    w[1] = w[3] = 0;
}

/* Eigenvalues of one matrix, which is overwritten, as re, im pairs; 0 where it converged. */
static int eigenvalues(int n, double *a, double *w)
{
    balance(n, a);
    hessenberg(n, a);
    int high = n - 1, turns = 0;
    while (high >= 0) {
        int low = high;
        while (low > 0) {
            const double size = fabs(AT(low - 1, low - 1)) + fabs(AT(low, low));
            if (fabs(AT(low, low - 1)) <= DBL_EPSILON * size) break;
            low--;
        }
        if (low == high) {
            w[2 * high] = AT(high, high);
            w[2 * high + 1] = 0;
            high--;
            turns = 0;
        } else if (low == high - 1) {
            pair(AT(low, low), AT(low, high), AT(high, low), AT(high, high), w + 2 * low);
            high -= 2;
            turns = 0;
        } else {
            if (++turns > 60) return 1;
            francis(n, a, low, high, turns % 11 == 10);
        }
    }
    return 0;
}

/* count matrices of n x n in a row; returns how many did not converge. */
int many_eigenvalues(long long count, int n, const double *matrices, double *w)
{
    double a[MOST * MOST];
    int failed = 0;
    if (n > MOST) return -1;
    for (long long i = 0; i < count; i++) {
        memcpy(a, matrices + i * n * n, (size_t)(n * n) * sizeof(double));
        failed += eigenvalues(n, a, w + 2 * n * i);
    }
    return failed;
}
