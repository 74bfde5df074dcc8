// The cases of a set, done side by side by a few threads.
#pragma once

#include <cstddef>
#include <functional>

namespace slewlab::diagnosis::withheld {

// Does work(0) ... work(count - 1), each once, begun in that order by `threads` threads at a time. `is_stopped` (may be empty) is asked
// before each, from any thread. False where it kept work from being done. What `work` throws ends the rest and is thrown again, unless all is being
// stopped: then it was thrown for that.
bool side_by_side(std::size_t count, int threads, const std::function<bool()>& is_stopped, const std::function<void(std::size_t)>& work);

}  // namespace slewlab::diagnosis::withheld
