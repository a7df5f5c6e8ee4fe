#pragma once
// The ticks of a replay as a table (CSV, RFC 4180): a header with a unit in each name, then a line for each tick. One
// thread.

#include <filesystem>
#include <string>

#include "engine/base/atomic_writer.h"
#include "haptics/replay/replay.h"

namespace shvr {

/// Columns of a table of ticks, with line break. `unit`: of the volume's lengths; empty: not known.
///
///     tick,time_s,read,buttons,hand_x_m,...,probe_x_UNIT,...,proxy_x_UNIT,...,force_x_n,...,in_contact,relevant_share,
///     objects,flags,energy_j
///
/// `time_s` counts from the first tick. `hand` is the device's position, in its own frame like the force. Positions
/// that are not finite are empty. `in_contact` is 0 as soon as the ball has left all relevant voxels, while the force
/// still fades. `flags` are the words of ForceFlag, joined by "|". `energy_j` is the sum of the forces' work so far; a
/// modelled device adds it up between ticks, with the forces that it delays, so it does not follow from other columns.
std::string tick_table_head(const std::string& unit);
/// Returns one line, with line break. `tick` counts from 0; `begin_ns` is the first tick's clock.
std::string tick_table_line(const ReplayedTick& replayed, uint64_t tick, uint64_t begin_ns);

/// "engaging|clamped"; empty for no flag.
std::string flag_words(uint32_t flags);

/// Writes the table to a file while a trace is replayed. The file is replaced only by `commit`.
class TickTable {
public:
    TickTable(const std::filesystem::path& path, const std::string& unit);
    void add(const ReplayedTick& tick);
    void commit();

private:
    void flush();
    AtomicWriter writer_;
    std::string text_;  ///< not yet written
    uint64_t ticks_ = 0, begin_ns_ = 0;
};

}  // namespace shvr
