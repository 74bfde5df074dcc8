// The map between the wire's signals and the variables of a PLC (`kind: plc_map`, docs/plc.md): which register, node or symbol holds which
// signal, in which type, and what one digit of it stands for.
//
//   to the PLC     value = signal / scale, rounded where the type is an integer
//   from the PLC   signal = value * scale
//
// A float without a scale holds the signal in SI. A counter has no scale and wraps where its type does.
// `slewlab bridge` and `slewlab soft-plc` read it by the extension slewlab._core, `slewlab check` and `slewlab schema` here.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/unit.h"
#include "common/yaml_reader.h"

namespace slewlab::tools {

enum class PlcProtocol { modbus, opcua, ads };
std::string_view name_of(PlcProtocol protocol);

enum class LinkLoss { brake, let_go, trip };
std::string_view name_of(LinkLoss reaction);

// Where a signal lies on a Modbus server; registers and coils count from 0, as in the protocol's frames.
enum class ModbusArea { holding, input, coil, discrete };
std::string_view name_of(ModbusArea area);

struct PlcSignal {
  std::string name;  // as in the file: "shaft_speed"
  int group = 0;     // of a signal that every motor group has
  bool to_plc = false;
  std::string at;    // in the protocol's own terms, as the file says it
  std::string type;  // bool, int16 ... uint64, float32, float64
  double scale = 1.0;  // SI per digit
  bool inverted = false;  // a flag that is false where the signal is true

  ModbusArea area = ModbusArea::holding;
  int number = 0;  // of register or coil
  int bit = -1;    // in the register; -1: the whole of it
};

struct PlcMap {
  PlcProtocol protocol = PlcProtocol::modbus;
  std::string address;       // modbus: HOST:PORT, opcua: URL, ads: HOST
  int modbus_unit = 1;       // unit identifier
  bool high_word_first = true;
  std::string ams_net_id;    // ads
  int ams_port = 851;        // ads
  bool ticked = false;       // computes one cycle for every new alive_counter, and says so by answered_counter
  double timeout = 0.0;      // [s] without an exchange after which the link counts as lost
  LinkLoss on_link_loss = LinkLoss::brake;
  int group_count = 0;
  std::vector<PlcSignal> signals;  // in the order of the signals' list, groups rising
};

// What a kind of file may hold as `type:`.
const std::vector<std::string>& plc_types();

// The settings of an opened file, but for finish().
void read_plc_map(common::YamlReader& reader, PlcMap& map);

// Throws common::InputError with every problem found.
PlcMap load_plc_map(const std::filesystem::path& file);

}  // namespace slewlab::tools
