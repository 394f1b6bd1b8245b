#pragma once

/// Compiles a function once per SIMD level and picks one when the program is loaded, so that a
/// packaged binary is fast on every machine. The results are the same bit for bit: the build never
/// fuses or reorders floating-point operations. Off under sanitizers, which break its resolvers,
/// and with VISMAP_BASELINE_KERNELS, by which a test proves it.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) && \
    !defined(VISMAP_BASELINE_KERNELS)
#define VISMAP_VECTOR_CLONES \
  __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define VISMAP_VECTOR_CLONES
#endif
