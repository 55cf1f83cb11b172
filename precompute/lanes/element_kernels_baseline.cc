#define PALPATE_LANES lanes_baseline
#include "precompute/lanes/element_kernels.inc"
