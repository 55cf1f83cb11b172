#define PALPATE_LANES lanes_avx2
#include "precompute/lanes/element_kernels.inc"
