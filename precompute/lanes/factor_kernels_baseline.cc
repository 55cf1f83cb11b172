#define PALPATE_LANES lanes_baseline
#include "precompute/lanes/factor_kernels.inc"
