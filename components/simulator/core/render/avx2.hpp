#pragma once

namespace lapis::simulator {

/// True when the processor has AVX2.
inline bool has_avx2() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

#if defined(__x86_64__)
/// Runs `work`, compiled for processors with AVX2, but without fused multiply-add, so that results are the same as on
/// any other processor.
template <class Work>
[[gnu::target("avx2"), gnu::flatten]] void with_avx2(const Work& work) {
  work();
}
#endif

/// Runs `work` with the widest instructions that the processor has; they change only the time that it takes.
template <class Work>
void run_wide(const Work& work) {
#if defined(__x86_64__)
  if (has_avx2()) return with_avx2(work);
#endif
  work();
}

}  // namespace lapis::simulator
