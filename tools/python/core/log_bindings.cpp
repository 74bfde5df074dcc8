#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <optional>
#include <slewlab_msgs/fields.hpp>

#include "msgs/messages.h"
#include "msgs/run_table.h"
#include "tools/python/core/bindings.h"
#include "tools/python/core/read_ahead.h"
#include "tools/python/core/tables.h"

namespace nb = nanobind;

namespace slewlab::tools {
namespace {

template <class Message>
void add_signals(nb::dict& channels, const char* channel) {
  nb::dict fields;
  msgs::visit_fields(Message{}, [&](const char* name, const char* unit, const auto&) { fields[name] = unit; });
  channels[channel] = fields;
}

nb::dict signals() {
  nb::dict channels;
  add_signals<msgs::Encoder>(channels, msgs::kEncoderChannel);
  add_signals<msgs::Torque>(channels, msgs::kTorqueChannel);
  add_signals<msgs::Operator>(channels, msgs::kOperatorChannel);
  add_signals<msgs::Sensors>(channels, msgs::kSensorsChannel);
  add_signals<msgs::Truth>(channels, msgs::kTruthChannel);
  add_signals<msgs::ControllerState>(channels, msgs::kControllerStateChannel);
  add_signals<msgs::PlantStatus>(channels, msgs::kPlantStatusChannel);
  add_signals<msgs::Motion>(channels, msgs::kMotionChannel);
  return channels;
}

std::string_view channel_of(const msgs::ChannelTable& table) { return msgs::wire_messages()[table.channel].channel; }

std::vector<bool> tables_of(const msgs::RunTables& run, const std::vector<std::string>& channels) {
  std::vector<bool> asked;
  for (const msgs::ChannelTable& table : run.tables()) {
    asked.push_back(std::find(channels.begin(), channels.end(), channel_of(table)) != channels.end());
  }
  return asked;
}

// As Python goes through it.
class Stretches {
 public:
  Stretches(const msgs::RunTables& run, const std::vector<std::string>& channels) : run_(run), ahead_(run, tables_of(run, channels)) {}

  nb::dict next() {
    std::optional<Stretch> stretch;
    {
      const nb::gil_scoped_release release;
      stretch = ahead_.next();
    }
    if (!stretch) throw nb::stop_iteration();
    nb::dict rows;
    for (TableRows& table : *stretch) {
      const std::string_view channel = channel_of(run_.tables()[table.table]);
      rows[nb::str(channel.data(), channel.size())] = row_bytes(std::move(table.bytes));
    }
    return rows;
  }

 private:
  const msgs::RunTables& run_;
  ReadAhead ahead_;
};

// A channel's rows, all of them.
RowBytes read_channel(const msgs::RunTables& run, const std::string& channel) {
  const std::vector<bool> asked = tables_of(run, {channel});
  std::vector<std::uint8_t> rows;
  {
    const nb::gil_scoped_release release;
    run.read(asked, {[&](std::size_t, std::size_t, msgs::Bytes bytes) { rows.insert(rows.end(), bytes.begin(), bytes.end()); }, [] {}});
  }
  return row_bytes(std::move(rows));
}

}  // namespace

void bind_log(nb::module_& m) {
  m.def("signals", &signals, "{channel: {field: unit}} of every message of the wire; \"-\" where a field has no unit.");
  nb::class_<msgs::RunTables>(m, "LogTables", "The longest run of a log, a table per channel.")
      .def(nb::init<std::filesystem::path>(), nb::arg("path"), nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("remarks", &msgs::RunTables::remarks, "What could not be used, one line each.")
      .def_prop_ro("channels",
                   [](const msgs::RunTables& run) {
                     std::vector<std::string> names;
                     for (const msgs::ChannelTable& table : run.tables()) names.emplace_back(channel_of(table));
                     return names;
                   })
      .def("layout",
           [](const msgs::RunTables& run, const std::string& channel) {
             for (const msgs::ChannelTable& table : run.tables()) {
               if (channel_of(table) == channel) return layout_of(table);
             }
             throw nb::key_error(channel.c_str());
           },
           nb::arg("channel"))
      .def("rows", &read_channel, nb::arg("channel"))
      .def("extent",
           [](const msgs::RunTables& run, const std::string& channel) {
             for (const msgs::ChannelTable& table : run.tables()) {
               if (channel_of(table) == channel) return nb::make_tuple(table.rows, table.first_time, table.last_time);
             }
             throw nb::key_error(channel.c_str());
           },
           nb::arg("channel"), "Number of messages, smallest and largest simulated time [ns].")
      .def_prop_ro("lateness", &msgs::RunTables::lateness,
                   "[ns] by which a message's simulated time may lie behind the latest one that was given out before it.")
      .def("stretches", [](const msgs::RunTables& run, const std::vector<std::string>& channels) { return new Stretches(run, channels); },
           nb::arg("channels"), nb::keep_alive<0, 1>(),
           "{channel: rows} of a stretch of the file after the other, decoded ahead by a thread of its own.");
  nb::class_<Stretches>(m, "Stretches")
      .def("__iter__", [](nb::handle self) { return self; }, nb::sig("def __iter__(self) -> Stretches"))
      .def("__next__", &Stretches::next, nb::sig("def __next__(self) -> dict[str, NDArray[numpy.uint8]]"));
}

}  // namespace slewlab::tools
