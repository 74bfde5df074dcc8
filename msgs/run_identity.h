#pragma once

// The number by which every message names the run it belongs to. The plant that starts a run says it, whoever answers
// returns it. Runs of one configuration share the configuration's hash; their identities tell them apart.

#include <cstdint>

namespace slewlab::msgs {

// The identity of the `number`-th run of a configuration, for launchers: the same inputs give the same bytes.
std::int64_t run_identity(std::int64_t configuration_hash, std::int64_t number = 0);

// One that no run on this machine had before: of a plant that nobody gave one.
std::int64_t fresh_run_identity();

}  // namespace slewlab::msgs
