#include "tools/plc/plc_map.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "common/input_error.h"
#include "common/near_name.h"
#include "common/readable_number.h"
#include "common/yaml_file.h"

namespace slewlab::tools {
namespace {

using common::Unit;
using common::YamlReader;

constexpr int kMostGroups = 8;        // as the wire has it
constexpr int kMostRegisters = 65536;  // of a Modbus area: addresses have 16 bits
constexpr int kBitsPerRegister = 16;
constexpr int kMostPorts = 65535;

enum class Kind { real, flag, counter, whole };

// A signal of the wire (msgs/*.lcm) as it may stand in a map.
struct SignalKind {
  const char* name;
  bool to_plc;
  Kind kind;
  Unit unit;       // of a real number
  bool per_group;
  bool is_required;
};

constexpr std::array kSignals{
    SignalKind{"shaft_speed", true, Kind::real, Unit::radian_per_second, true, true},
    SignalKind{"shaft_position", true, Kind::real, Unit::radian, true, false},
    SignalKind{"speed_request", true, Kind::real, Unit::none, false, true},
    SignalKind{"emergency_stop", true, Kind::flag, Unit::none, false, true},
    SignalKind{"acknowledge", true, Kind::flag, Unit::none, false, true},
    SignalKind{"alive_counter", true, Kind::counter, Unit::none, false, true},
    SignalKind{"simulated_time", true, Kind::real, Unit::second, false, false},
    SignalKind{"motor_torque", false, Kind::real, Unit::newton_metre, true, true},
    SignalKind{"enable", false, Kind::flag, Unit::none, false, true},
    SignalKind{"brake", false, Kind::flag, Unit::none, false, true},
    SignalKind{"acknowledge", false, Kind::flag, Unit::none, false, true},
    SignalKind{"alive_counter", false, Kind::counter, Unit::none, false, true},
    SignalKind{"answered_counter", false, Kind::counter, Unit::none, false, false},
    SignalKind{"mode", false, Kind::whole, Unit::none, false, false},
    SignalKind{"ramped_speed", false, Kind::real, Unit::radian_per_second, false, false},
    SignalKind{"average_torque", false, Kind::real, Unit::newton_metre, false, false},
    SignalKind{"offset_torque", false, Kind::real, Unit::newton_metre, false, false},
    SignalKind{"proportional_torque", false, Kind::real, Unit::newton_metre, true, false},
    SignalKind{"integral_torque", false, Kind::real, Unit::newton_metre, true, false},
};

bool is_float(const std::string& type) { return type == "float32" || type == "float64"; }

int registers_of(const std::string& type) {
  if (type.ends_with("64")) return 4;
  return type.ends_with("32") ? 2 : 1;
}

std::optional<int> number_in(std::string_view text) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

// "holding 12" or "holding 12.3": the bit 3 of register 12, its lowest being 0.
bool parse_modbus(PlcSignal& signal) {
  static constexpr ModbusArea kAreas[] = {ModbusArea::holding, ModbusArea::input, ModbusArea::coil, ModbusArea::discrete};
  const std::size_t blank = signal.at.find(' ');
  if (blank == std::string::npos) return false;
  const auto area = std::find_if(std::begin(kAreas), std::end(kAreas),
                                 [&](ModbusArea each) { return signal.at.compare(0, blank, name_of(each)) == 0; });
  if (area == std::end(kAreas)) return false;
  std::string_view place = std::string_view(signal.at).substr(blank + 1);
  const std::size_t dot = place.find('.');
  if (dot != std::string_view::npos) {
    const std::optional<int> bit = number_in(place.substr(dot + 1));
    if (!bit || *bit >= kBitsPerRegister) return false;
    signal.bit = *bit;
    place = place.substr(0, dot);
  }
  const std::optional<int> number = number_in(place);
  if (!number || *number >= kMostRegisters) return false;
  signal.area = *area;
  signal.number = *number;
  return true;
}

// What the signals so far occupy on a Modbus server, in bits of its areas.
struct Occupied {
  ModbusArea area;
  int first, last;
  std::string name;
};

bool is_of_bits(ModbusArea area) { return area == ModbusArea::coil || area == ModbusArea::discrete; }

std::string described(const PlcSignal& signal, bool per_group) {
  return per_group ? signal.name + " of group " + std::to_string(signal.group + 1) : signal.name;
}

void check_modbus_place(YamlReader& entry, PlcSignal& signal, const SignalKind& kind, std::vector<Occupied>& occupied) {
  if (!parse_modbus(signal)) {
    entry.report("at", "'" + signal.at + "'",
                 "holding N, input N, coil N or discrete N, N from 0 to 65535; holding N.B or input N.B for a flag in bit B, 0 to 15");
    return;
  }
  const bool is_bit = is_of_bits(signal.area) || signal.bit >= 0;
  if (is_of_bits(signal.area) && signal.bit >= 0) {
    entry.report("at", "'" + signal.at + "', a bit of a bit", std::string(name_of(signal.area)) + " N");
    return;
  }
  if (kind.to_plc && (signal.area == ModbusArea::input || signal.area == ModbusArea::discrete)) {
    entry.report("at", "'" + signal.at + "', which a server lets nobody write", "a holding register or a coil: this signal goes to the PLC");
  }
  if (kind.kind == Kind::flag && signal.type != "bool") {
    entry.report("type", "'" + signal.type + "'", "bool: a flag");
    return;
  }
  if (kind.kind != Kind::flag && is_bit) {
    entry.report("at", "'" + signal.at + "', one bit", "a register: this signal is a number");
    return;
  }
  const bool by_bits = is_of_bits(signal.area);
  const int begin = by_bits ? signal.number : signal.number * kBitsPerRegister + std::max(0, signal.bit);
  const int bits = is_bit ? 1 : kBitsPerRegister * (signal.type == "bool" ? 1 : registers_of(signal.type));
  if (!by_bits && begin + bits > kMostRegisters * kBitsPerRegister) {
    entry.report("at", "'" + signal.at + "' and the registers behind it", "registers up to 65535");
  }
  for (const Occupied& other : occupied) {
    if (other.area != signal.area || begin > other.last || begin + bits <= other.first) continue;
    entry.report("at", "'" + signal.at + "', where " + other.name + " lies", "a place of its own for every signal");
    return;
  }
  occupied.push_back({signal.area, begin, begin + bits - 1, described(signal, kind.per_group)});
}

void check_node(YamlReader& entry, const PlcSignal& signal) {
  std::string_view text = signal.at;
  if (text.starts_with("ns=")) {
    const std::size_t end = text.find(';');
    if (end == std::string_view::npos || !number_in(text.substr(3, end - 3))) text = {};
    else text = text.substr(end + 1);
  }
  const bool known = text.size() > 2 && text[1] == '=' && std::string_view("isgb").find(text[0]) != std::string_view::npos;
  if (!known || (text[0] == 'i' && !number_in(text.substr(2)))) {
    entry.report("at", "'" + signal.at + "'", "a node's identifier, such as ns=2;s=Slewing.Torque1 or ns=4;i=17");
  }
}

void check_symbol(YamlReader& entry, const PlcSignal& signal) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' || c == '[' || c == ']';
  };
  if (signal.at.empty() || !std::all_of(signal.at.begin(), signal.at.end(), is_allowed)) {
    entry.report("at", "'" + signal.at + "'", "the name of a symbol, such as GVL.Torque[1] or MAIN.enable");
  }
}

void read_type(YamlReader& entry, PlcSignal& signal, const SignalKind& kind) {
  if (kind.kind == Kind::flag) {
    signal.type = "bool";
    if (entry.has("inverted")) signal.inverted = entry.flag("inverted");
    return;
  }
  signal.type = entry.text("type");
  if (signal.type.empty()) return;
  const auto& types = plc_types();
  if (std::find(types.begin(), types.end(), signal.type) == types.end()) {
    entry.report("type", "'" + signal.type + "'", common::known_names_text(signal.type, types));
    signal.type.clear();
  } else if (signal.type == "bool" || (kind.kind != Kind::real && is_float(signal.type))) {
    entry.report("type", "'" + signal.type + "'", kind.kind == Kind::real ? "a number's type" : "a whole number's type, int16 to uint64");
    signal.type.clear();
  }
}

// Whether the file says so; of what cannot be read a reader answers 0 too.
bool is_zero(YamlReader& entry, std::string_view key) {
  const common::YamlNode* node = entry.raw(key);
  const common::YamlNode* value = node == nullptr ? nullptr : node->find("value");
  double number = 1.0;
  return value != nullptr && common::parse_number(value->scalar, number) && number == 0.0;
}

// [SI] The least that a number of the signal's kind has to reach for any machine to be moved by it: what a type cannot hold is clipped.
constexpr double kLeastSpeed = 1.0;    // [rad/s] of a motor's shaft: 10 rpm at full speed
constexpr double kLeastTorque = 1e-3;  // [Nm] per motor: a gram at ten centimetres

void check_reach(YamlReader& entry, const PlcSignal& signal, const SignalKind& kind) {
  if (is_float(signal.type) || signal.type.empty() || signal.scale == 0.0) return;
  const bool is_request = std::string_view(kind.name) == "speed_request";
  const double needed = is_request ? 1.0 : kind.unit == Unit::radian_per_second ? kLeastSpeed : kind.unit == Unit::newton_metre ? kLeastTorque : 0.0;
  if (needed == 0.0) return;
  const bool has_sign = !signal.type.starts_with('u');
  const int bits = kBitsPerRegister * registers_of(signal.type) - (has_sign ? 1 : 0);
  const double reach = (std::ldexp(1.0, bits) - 1.0) * std::abs(signal.scale);
  if (reach < needed) {
    const std::string unit = kind.unit == Unit::none ? "" : ' ' + std::string(common::name_of(kind.unit));
    entry.report("scale", "a scale with which " + signal.type + " holds no more than " + common::readable(reach) + unit,
                 is_request ? "one with which 1, the whole of the lever, has a place" : "what one digit stands for: nothing larger could be said");
  }
}

void read_signal(YamlReader& entry, PlcProtocol protocol, PlcSignal& signal, const SignalKind& kind, std::vector<Occupied>& occupied) {
  signal.name = kind.name;
  signal.to_plc = kind.to_plc;
  signal.at = entry.text("at");
  read_type(entry, signal, kind);
  if (kind.kind == Kind::real) {
    const std::optional<double> scale = entry.optional_number("scale", kind.unit, common::any_number());
    if (scale && is_zero(entry, "scale")) entry.report("scale", "0", "what one digit stands for, not 0; below 0 turns the sign");
    if (!scale && !signal.type.empty() && !is_float(signal.type)) {
      entry.report("scale", "nothing: the key is missing",
                   "what one digit of the " + signal.type + " stands for: {value: ..., unit: one of " + common::spellings_of(kind.unit) +
                       ", source: ...}");
    }
    signal.scale = scale.value_or(1.0);
    if (scale) check_reach(entry, signal, kind);
  }
  if (!signal.at.empty() && !signal.type.empty()) {
    switch (protocol) {
      case PlcProtocol::modbus: check_modbus_place(entry, signal, kind, occupied); break;
      case PlcProtocol::opcua: check_node(entry, signal); break;
      case PlcProtocol::ads: check_symbol(entry, signal); break;
    }
  }
  entry.finish();
}

// The number of motor groups: `groups`, or where that is 0 as many as the first signal of groups has.
int read_side(YamlReader side, bool to_plc, PlcMap& map, int groups, std::vector<Occupied>& occupied) {
  for (const SignalKind& kind : kSignals) {
    if (kind.to_plc != to_plc || !(kind.is_required || side.has(kind.name))) continue;
    if (!kind.per_group) {
      PlcSignal signal;
      YamlReader entry = side.map(kind.name);
      read_signal(entry, map.protocol, signal, kind, occupied);
      map.signals.push_back(signal);
      continue;
    }
    int count = 0;
    side.each(kind.name, [&](YamlReader& entry) {
      PlcSignal signal;
      signal.group = count++;
      read_signal(entry, map.protocol, signal, kind, occupied);
      map.signals.push_back(signal);
    });
    if (groups == 0) groups = count;
    if (count == 0 || count > kMostGroups) {
      side.report(kind.name, std::to_string(count) + " entries", "one for every motor group, 1 to " + std::to_string(kMostGroups));
    } else if (count != groups) {
      side.report(kind.name, std::to_string(count) + " entries", std::to_string(groups) + ", as many as shaft_speed has: one per motor group");
    }
  }
  side.finish();
  return groups;
}

bool is_port(std::optional<int> number) { return number && *number >= 1 && *number <= kMostPorts; }

bool has_signal(const PlcMap& map, std::string_view name, bool to_plc) {
  return std::any_of(map.signals.begin(), map.signals.end(),
                     [&](const PlcSignal& signal) { return signal.name == name && signal.to_plc == to_plc; });
}

}  // namespace

std::string_view name_of(PlcProtocol protocol) {
  switch (protocol) {
    case PlcProtocol::modbus: return "modbus";
    case PlcProtocol::opcua: return "opcua";
    case PlcProtocol::ads: return "ads";
  }
  return {};
}

std::string_view name_of(LinkLoss reaction) {
  switch (reaction) {
    case LinkLoss::brake: return "brake";
    case LinkLoss::let_go: return "let_go";
    case LinkLoss::trip: return "trip";
  }
  return {};
}

std::string_view name_of(ModbusArea area) {
  switch (area) {
    case ModbusArea::holding: return "holding";
    case ModbusArea::input: return "input";
    case ModbusArea::coil: return "coil";
    case ModbusArea::discrete: return "discrete";
  }
  return {};
}

const std::vector<std::string>& plc_types() {
  static const std::vector<std::string> kTypes{"bool", "int16", "uint16", "int32", "uint32", "int64", "uint64", "float32", "float64"};
  return kTypes;
}

void read_plc_map(YamlReader& reader, PlcMap& map) {
  constexpr double kLongestTimeout = 60.0;  // [s]
  constexpr int kMostUnits = 255;
  reader.heading("plc_map");
  map.protocol = static_cast<PlcProtocol>(reader.choice("protocol", {"modbus", "opcua", "ads"}));
  map.address = reader.text("address");
  switch (map.protocol) {
    case PlcProtocol::modbus: {
      const std::size_t colon = map.address.rfind(':');
      const std::optional<int> port = colon == std::string::npos ? std::nullopt : number_in(std::string_view(map.address).substr(colon + 1));
      if (!map.address.empty() && !is_port(port)) {
        reader.report("address", "'" + map.address + "'", "HOST:PORT, such as 192.168.0.10:502, with a port from 1 to 65535");
      }
      map.modbus_unit = reader.has("unit_identifier") ? reader.integer("unit_identifier", 0, kMostUnits) : 1;
      map.high_word_first = reader.choice("word_order", {"high_first", "low_first"}) == 0;
      break;
    }
    case PlcProtocol::opcua:
      if (!map.address.empty() && !map.address.starts_with("opc.tcp://")) {
        reader.report("address", "'" + map.address + "'", "opc.tcp://HOST:PORT, such as opc.tcp://192.168.0.10:4840");
      }
      break;
    case PlcProtocol::ads:
      map.ams_net_id = reader.text("ams_net_id");
      if (!map.ams_net_id.empty() && std::count(map.ams_net_id.begin(), map.ams_net_id.end(), '.') != 5) {
        reader.report("ams_net_id", "'" + map.ams_net_id + "'", "six numbers with dots between, such as 192.168.0.10.1.1");
      }
      map.ams_port = reader.has("ams_port") ? reader.integer("ams_port", 1, kMostPorts) : 851;
      break;
  }
  map.ticked = reader.flag("ticked");
  map.timeout = reader.number("timeout", Unit::second, {1e-3, kLongestTimeout, true});
  map.on_link_loss = static_cast<LinkLoss>(reader.choice("on_link_loss", {"brake", "let_go", "trip"}));
  std::vector<Occupied> occupied;
  map.group_count = read_side(reader.map("to_plc"), true, map, 0, occupied);
  read_side(reader.map("from_plc"), false, map, map.group_count, occupied);
  if (map.ticked && !has_signal(map, "answered_counter", false)) {
    reader.report("ticked", "true", "from_plc.answered_counter beside it: by it the PLC says which alive_counter it has computed with");
  }
}

PlcMap load_plc_map(const std::filesystem::path& file) {
  common::InputProblems problems;
  const common::YamlNode root = common::load_yaml_file(file, {}, problems);
  if (root.kind != common::YamlNode::Kind::map) throw common::InputError(problems);
  YamlReader reader(root, "", problems);
  PlcMap map;
  read_plc_map(reader, map);
  reader.finish();
  if (!problems.empty()) throw common::InputError(problems);
  return map;
}

}  // namespace slewlab::tools
