// The one place that says which field of a recording is which object of its file; the
// writer and the reader walk these tables.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "formats/recording/recording.h"
#include "formats/stored/stored_type.h"

namespace palpate::recording {

/// A dataset of `width` values per row (1: one-dimensional), from a member of a row.
struct Column {
  const char* path;
  const char* units;
  StoredType type;
  std::size_t offset;  ///< [bytes] of the member in the row
  std::size_t width;
  const char* former = nullptr;  ///< path in versions 1 to 3, where it was another
};

struct TextField {
  const char* name;  ///< of the attribute of "/"
  std::string RecordingHeader::*member;
};

struct NumberField {
  const char* name;
  double RecordingHeader::*member;
};

inline constexpr const char* kFormat = "palpate-recording";

inline constexpr std::array kTickColumns{
    Column{"/tick/number", "1", StoredType::kInt64, offsetof(TickRecord, tick), 1},
    Column{"/tick/time_ns", "ns", StoredType::kInt64, offsetof(TickRecord, time_ns), 1},
    Column{"/tick/arrivals", "1", StoredType::kInt64, offsetof(TickRecord, arrivals),
           1},
    Column{"/tick/position_m", "m", StoredType::kFloat64,
           offsetof(TickRecord, position_m), 3},
    Column{"/tick/force_n", "N", StoredType::kFloat64, offsetof(TickRecord, force_n),
           3},
    Column{"/tick/depth_m", "m", StoredType::kFloat64, offsetof(TickRecord, depth_m),
           1},
    Column{"/tick/work_j", "J", StoredType::kFloat64, offsetof(TickRecord, work_j), 1},
    Column{"/tick/stored_j", "J", StoredType::kFloat64, offsetof(TickRecord, stored_j),
           1},
    Column{"/tick/tank_j", "J", StoredType::kFloat64, offsetof(TickRecord, tank_j), 1},
    Column{"/tick/dissipated_j", "J", StoredType::kFloat64,
           offsetof(TickRecord, dissipated_j), 1},
    Column{"/tick/relaxed_shift_m", "m", StoredType::kFloat64,
           offsetof(TickRecord, rest_offset_m), 1, "/tick/relaxed_shift_m"},
    Column{"/tick/triangle", "1", StoredType::kInt32, offsetof(TickRecord, triangle),
           1},
    Column{"/tick/flags", "1", StoredType::kUint8, offsetof(TickRecord, flags), 1},
    Column{"/tick/raised", "1", StoredType::kUint8, offsetof(TickRecord, raised), 1},
    Column{"/tick/fault", "1", StoredType::kUint8, offsetof(TickRecord, fault), 1}};

/// There only where the header says that ticks have poses.
inline constexpr std::array kPoseColumns{
    Column{"/tick/turn", "1", StoredType::kFloat64, offsetof(TickRecord, turn), 4},
    Column{"/tick/torque_n_m", "N.m", StoredType::kFloat64,
           offsetof(TickRecord, torque_n_m), 3},
    Column{"/tick/contacts", "1", StoredType::kInt32, offsetof(TickRecord, contacts),
           1}};

/// There only where there is a second hand.
inline constexpr std::array kSecondColumns{
    Column{"/tick/second_position_m", "m", StoredType::kFloat64,
           offsetof(TickRecord, second) + offsetof(RecordedHand, position_m), 3},
    Column{"/tick/second_turn", "1", StoredType::kFloat64,
           offsetof(TickRecord, second) + offsetof(RecordedHand, turn), 4},
    Column{"/tick/second_force_n", "N", StoredType::kFloat64,
           offsetof(TickRecord, second) + offsetof(RecordedHand, force_n), 3},
    Column{"/tick/second_torque_n_m", "N.m", StoredType::kFloat64,
           offsetof(TickRecord, second) + offsetof(RecordedHand, torque_n_m), 3}};

inline constexpr std::array kArrivalColumns{
    Column{"/arrival/tick", "1", StoredType::kInt64, offsetof(ArrivalRecord, tick), 1},
    Column{"/arrival/sequence", "1", StoredType::kInt64,
           offsetof(ArrivalRecord, sequence), 1},
    Column{"/arrival/sent_ns", "ns", StoredType::kInt64,
           offsetof(ArrivalRecord, sent_ns), 1},
    Column{"/arrival/triangle", "1", StoredType::kInt32,
           offsetof(ArrivalRecord, triangle), 1},
    Column{"/arrival/active", "1", StoredType::kUint8, offsetof(ArrivalRecord, active),
           1}};

inline constexpr std::array kContactColumns{Column{
    "/arrival/contact", "1", StoredType::kInt32, offsetof(ArrivalRecord, contact), 1}};

/// There only where something had yielded.
inline constexpr std::array kSurfaceColumns{
    Column{"/surface/site", "1", StoredType::kInt32, offsetof(YieldedRow, site), 1},
    Column{"/surface/dent_m", "m", StoredType::kFloat64, offsetof(YieldedRow, dent_m),
           1},
    Column{"/surface/softened_m", "m", StoredType::kFloat64,
           offsetof(YieldedRow, softened_m), 1}};

inline constexpr std::array kSurfaceTableColumns{
    Column{"/surface/table", "1", StoredType::kInt32, offsetof(YieldedRow, table), 1}};

/// There only where needles had cut, from version 5 on.
inline constexpr std::array kChannelColumns{
    Column{"/channel/entry_m", "m", StoredType::kFloat64, offsetof(ChannelRow, entry_m),
           3},
    Column{"/channel/axis", "1", StoredType::kFloat64, offsetof(ChannelRow, axis), 3},
    Column{"/channel/depth_m", "m", StoredType::kFloat64, offsetof(ChannelRow, depth_m),
           1},
    Column{"/channel/layer", "1", StoredType::kInt32, offsetof(ChannelRow, layer), 1},
    Column{"/channel/layer_depth_m", "m", StoredType::kFloat64,
           offsetof(ChannelRow, layer_depth_m), kKeptLayers},
    Column{"/channel/layer_material", "1", StoredType::kInt32,
           offsetof(ChannelRow, layer_material), kKeptLayers},
    Column{"/channel/table", "1", StoredType::kInt32, offsetof(ChannelRow, table), 1}};

inline constexpr std::array kTexts{
    TextField{"writer", &RecordingHeader::writer},
    TextField{"database", &RecordingHeader::database},
    TextField{"database_sha256", &RecordingHeader::database_sha256},
    TextField{"tool", &RecordingHeader::tool},
    TextField{"model", &RecordingHeader::model},
    TextField{"clock", &RecordingHeader::clock},
    TextField{"device", &RecordingHeader::device}};

inline constexpr std::array kNumbers{
    NumberField{"fast_hz", &RecordingHeader::fast_hz},
    NumberField{"slow_hz", &RecordingHeader::slow_hz},
    NumberField{"force_scale", &RecordingHeader::force_scale},
    NumberField{"tool_radius_m", &RecordingHeader::tool_radius_m},
    NumberField{"force_max_n", &RecordingHeader::force_max_n},
    NumberField{"slew_max_n_per_s", &RecordingHeader::slew_max_n_per_s},
    NumberField{"energy_floor_j", &RecordingHeader::energy_floor_j},
    NumberField{"recovery_m_per_s", &RecordingHeader::recovery_m_per_s},
    NumberField{"ramp_s", &RecordingHeader::ramp_s},
    NumberField{"device_damping_n_s_per_m", &RecordingHeader::device_damping_n_s_per_m},
    NumberField{"device_coulomb_n", &RecordingHeader::device_coulomb_n},
    NumberField{"device_resolution_m", &RecordingHeader::device_resolution_m},
    NumberField{"device_delay_s", &RecordingHeader::device_delay_s}};

/// From version 3 on.
inline constexpr std::array kAddedTexts{
    TextField{"second_tool", &RecordingHeader::second_tool}};

inline constexpr std::array kAddedNumbers{
    NumberField{"poses", &RecordingHeader::poses},
    NumberField{"torque_felt", &RecordingHeader::torque_felt},
    NumberField{"coupling_mass_kg", &RecordingHeader::coupling_mass_kg},
    NumberField{"coupling_inertia_x_kg_m2", &RecordingHeader::coupling_inertia_x_kg_m2},
    NumberField{"coupling_inertia_y_kg_m2", &RecordingHeader::coupling_inertia_y_kg_m2},
    NumberField{"coupling_inertia_z_kg_m2", &RecordingHeader::coupling_inertia_z_kg_m2},
    NumberField{"coupling_spring_n_per_m", &RecordingHeader::coupling_spring_n_per_m},
    NumberField{"coupling_spring_n_m_per_rad",
                &RecordingHeader::coupling_spring_n_m_per_rad},
    NumberField{"coupling_damper_n_s_per_m",
                &RecordingHeader::coupling_damper_n_s_per_m},
    NumberField{"coupling_damper_n_m_s", &RecordingHeader::coupling_damper_n_m_s},
    NumberField{"coupling_lever_m", &RecordingHeader::coupling_lever_m}};

/// The columns of ticks and of arrivals that a header asks for.
inline std::vector<Column> tick_columns(const RecordingHeader& header) {
  std::vector<Column> all(kTickColumns.begin(), kTickColumns.end());
  if (header.poses != 0.0) {
    all.insert(all.end(), kPoseColumns.begin(), kPoseColumns.end());
  }
  if (!header.second_tool.empty()) {
    all.insert(all.end(), kSecondColumns.begin(), kSecondColumns.end());
  }
  return all;
}

inline std::vector<Column> arrival_columns(const RecordingHeader& header) {
  std::vector<Column> all(kArrivalColumns.begin(), kArrivalColumns.end());
  if (header.poses != 0.0) {
    all.insert(all.end(), kContactColumns.begin(), kContactColumns.end());
  }
  return all;
}

inline std::vector<Column> surface_columns(const RecordingHeader& header) {
  std::vector<Column> all(kSurfaceColumns.begin(), kSurfaceColumns.end());
  if (header.poses != 0.0) {
    all.insert(all.end(), kSurfaceTableColumns.begin(), kSurfaceTableColumns.end());
  }
  return all;
}

}  // namespace palpate::recording
