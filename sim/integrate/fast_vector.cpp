#include "sim/integrate/fast_vector.h"

#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>

namespace slewlab::sim {

namespace {

double* data(N_Vector vector) { return NV_DATA_S(vector); }
int length(N_Vector vector) { return static_cast<int>(NV_LENGTH_S(vector)); }

// The result may be one of the operands; entries never depend on each other.
void linear_sum(double a, N_Vector x, double b, N_Vector y, N_Vector z) {
  const double* px = data(x);
  const double* py = data(y);
  double* pz = data(z);
  const int n = length(z);
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) pz[i] = a * px[i] + b * py[i];
}

void scale(double a, N_Vector x, N_Vector z) {
  const double* px = data(x);
  double* pz = data(z);
  const int n = length(z);
#pragma GCC ivdep
  for (int i = 0; i < n; ++i) pz[i] = a * px[i];
}

void constant(double a, N_Vector z) { std::fill_n(data(z), length(z), a); }

double weighted_norm(N_Vector x, N_Vector weights) {
  const double* px = data(x);
  const double* pw = data(weights);
  const int n = length(x);
  double sum[4] = {};
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    for (int j = 0; j < 4; ++j) {
      const double product = px[i + j] * pw[i + j];
      sum[j] += product * product;
    }
  }
  for (; i < n; ++i) sum[0] += px[i] * pw[i] * px[i] * pw[i];
  return std::sqrt(((sum[0] + sum[1]) + (sum[2] + sum[3])) / n);
}

// z = sum of c[k] x[k]; SUNDIALS allows z to be x[0], and calls no other order.
int linear_combination(int count, double* c, N_Vector* x, N_Vector z) {
  double* pz = data(z);
  const int n = length(z);
  if (count == 1) {
    scale(c[0], x[0], z);
    return 0;
  }
  linear_sum(c[0], x[0], c[1], x[1], z);
  int k = 2;
  for (; k + 2 <= count; k += 2) {
    const double* first = data(x[k]);
    const double* second = data(x[k + 1]);
    const double c_first = c[k], c_second = c[k + 1];
#pragma GCC ivdep
    for (int i = 0; i < n; ++i) pz[i] += c_first * first[i] + c_second * second[i];
  }
  if (k < count) linear_sum(1.0, z, c[k], x[k], z);
  return 0;
}

// z[k] = a[k] x + y[k]
int scale_add_multi(int count, double* a, N_Vector x, N_Vector* y, N_Vector* z) {
  for (int k = 0; k < count; ++k) linear_sum(a[k], x, 1.0, y[k], z[k]);
  return 0;
}

}  // namespace

N_Vector make_fast_vector(int size, SUNContext context) {
  N_Vector vector = N_VNew_Serial(size, context);
  if (vector == nullptr) return nullptr;
  vector->ops->nvlinearsum = linear_sum;
  vector->ops->nvscale = scale;
  vector->ops->nvconst = constant;
  vector->ops->nvwrmsnorm = weighted_norm;
  vector->ops->nvlinearcombination = linear_combination;
  vector->ops->nvscaleaddmulti = scale_add_multi;
  return vector;
}

}  // namespace slewlab::sim
