#include "tools/python/core/read_ahead.h"

#include <utility>

namespace slewlab::tools {
namespace {

constexpr std::size_t kMostWaiting = 2;

struct Left {};  // ends a reading that nobody takes any more

}  // namespace

ReadAhead::ReadAhead(const msgs::RunTables& tables, std::vector<bool> asked)
    : thread_([this, &tables, asked = std::move(asked)] { read(tables, asked); }) {}

ReadAhead::~ReadAhead() {
  {
    const std::lock_guard lock(mutex_);
    is_left_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ReadAhead::read(const msgs::RunTables& tables, const std::vector<bool>& asked) {
  Stretch stretch;
  std::exception_ptr problem;
  try {
    tables.read(asked, {[&](std::size_t table, std::size_t, msgs::Bytes bytes) { stretch.push_back({table, {bytes.begin(), bytes.end()}}); },
                        [&] { put(std::exchange(stretch, {})); }});
  } catch (const Left&) {
  } catch (...) {
    problem = std::current_exception();
  }
  const std::lock_guard lock(mutex_);
  problem_ = problem;
  has_ended_ = true;
  changed_.notify_all();
}

void ReadAhead::put(Stretch stretch) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return is_left_ || waiting_.size() < kMostWaiting; });
  if (is_left_) throw Left{};
  waiting_.push_back(std::move(stretch));
  changed_.notify_all();
}

std::optional<Stretch> ReadAhead::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return has_ended_ || !waiting_.empty(); });
  if (waiting_.empty()) {
    if (problem_) std::rethrow_exception(std::exchange(problem_, nullptr));
    return std::nullopt;
  }
  Stretch stretch = std::move(waiting_.front());
  waiting_.pop_front();
  changed_.notify_all();
  return stretch;
}

}  // namespace slewlab::tools
