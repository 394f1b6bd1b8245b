#pragma once

/// Compiles a function once per SIMD level; the program chooses one when it starts, so that one
/// binary is fast on every machine. The results are equal bit for bit, since the build never fuses
/// or reorders floating-point operations; tests/oracle/map_hash.cc checks that with builds of one
/// level each (VISMAP_BASELINE_KERNELS). Off under sanitizers, which do not support it.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(VISMAP_BASELINE_KERNELS)
#define VISMAP_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define VISMAP_VECTOR_CLONES
#endif
