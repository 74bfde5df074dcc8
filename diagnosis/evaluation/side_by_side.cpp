#include "diagnosis/evaluation/side_by_side.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace slewlab::diagnosis::withheld {

bool side_by_side(std::size_t count, int threads, const std::function<bool()>& is_stopped, const std::function<void(std::size_t)>& work) {
  const auto stopped = [&] { return is_stopped && is_stopped(); };
  std::atomic<std::size_t> next{0};
  std::atomic<std::size_t> done{0};
  std::mutex failing;
  std::exception_ptr failure;
  const auto run = [&] {
    while (!stopped()) {
      const std::size_t mine = next++;
      if (mine >= count) return;
      try {
        work(mine);
        ++done;
      } catch (...) {
        next = count;
        const std::lock_guard lock(failing);
        if (!failure) failure = std::current_exception();
        return;
      }
    }
  };
  {
    std::vector<std::jthread> others;
    for (int t = 1; t < std::max(1, threads); ++t) others.emplace_back(run);
    run();
  }
  if (failure && !stopped()) std::rethrow_exception(failure);
  return done == count;
}

}  // namespace slewlab::diagnosis::withheld
