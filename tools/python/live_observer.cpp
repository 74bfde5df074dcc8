// slewlab-live-observer MACHINE.yaml: the diagnosis' observer (diagnosis/live_observer.h) at the end of a pipe, for
// tools/python/desk/gap.py. Standard input is a log in LCM's event format as it grows. Standard output, a line of JSON each:
//   {"characteristic_time": s}                                                          first
//   {"time": [s], "missing_torque": [[Nm per motor] per group], "acceleration_difference": {"tip": [m/s^2], ...}}
//   {"begins_again": "why"}                                                             behind a gap in the messages
// Ends with its input. Exit code 2: the machine cannot be used.

#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "diagnosis/live_observer.h"
#include "msgs/log_writer.h"
#include "sim/drive/scenario_run.h"
#include "sim/machine/machine_file.h"

namespace {

using namespace slewlab;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLargestEvent = 1 << 20;  // [bytes]

std::uint32_t word_at(const std::string& bytes, std::size_t place) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[place + i]);
  return value;
}

void say(const Json& line) {
  std::printf("%s\n", line.dump().c_str());
  std::fflush(stdout);
}

// As floats: what is read is drawn. What is not a number is null.
Json rounded(const std::vector<double>& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(static_cast<float>(value));
  return list;
}

Json described(const diagnosis::LiveGap& gap) {
  if (gap.time.empty()) return {{"begins_again", gap.begins_again}};
  Json line{{"time", gap.time}, {"missing_torque", Json::array()}, {"acceleration_difference", Json::object()}};
  for (const auto& series : gap.missing_torque) {
    if (!series.empty()) line["missing_torque"].push_back(rounded(series));
  }
  for (int a = 0; a < diagnosis::kAccelerometerCount; ++a) {
    const auto& series = gap.acceleration_difference[static_cast<std::size_t>(a)];
    if (!series.empty()) line["acceleration_difference"][diagnosis::accelerometer_name(a)] = rounded(series);
  }
  return line;
}

// Takes the whole events off the front of `bytes`. The pipe comes from the desk, which sends nothing else.
void take_events(std::string& bytes, diagnosis::LiveObserver& observer) {
  std::size_t place = 0;
  while (bytes.size() - place >= msgs::kLogEventHeadBytes) {
    const std::size_t channel = word_at(bytes, place + 20), data = word_at(bytes, place + 24);
    if (word_at(bytes, place) != msgs::kLogSyncWord || channel + data > kLargestEvent) throw std::runtime_error("what comes is no log");
    const std::size_t begin = place + msgs::kLogEventHeadBytes;
    if (bytes.size() - begin < channel + data) break;
    observer.take(bytes.substr(begin, channel), {reinterpret_cast<const std::uint8_t*>(bytes.data()) + begin + channel, data});
    place = begin + channel + data;
    if (const auto gap = observer.look()) say(described(*gap));
  }
  bytes.erase(0, place);
}

int run(const std::string& file) {
  const sim::MachineFile machine = sim::load_machine_file(file);
  diagnosis::LiveObserver observer(sim::machine_settings(machine));
  say({{"characteristic_time", observer.time()}});
  std::string bytes;
  std::vector<char> buffer(1 << 16);
  for (ssize_t count; (count = ::read(STDIN_FILENO, buffer.data(), buffer.size())) > 0;) {
    bytes.append(buffer.data(), static_cast<std::size_t>(count));
    take_events(bytes, observer);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: slewlab-live-observer MACHINE.yaml\n");
    return 2;
  }
  try {
    return run(argv[1]);
  } catch (const slewlab::common::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "slewlab-live-observer: %s\n", error.what());
    return 1;
  }
}
