#include "haptics/replay/tick_table.h"

#include <cmath>
#include <string_view>
#include <utility>

#include "engine/base/text.h"

namespace shvr {
namespace {

constexpr std::pair<uint32_t, std::string_view> FLAG_WORDS[] = {
    {FORCE_NO_DEVICE, "no_device"}, {FORCE_NO_REGION, "no_region"},
    {FORCE_FAULT, "fault"},         {FORCE_CLAMPED, "clamped"},
    {FORCE_ENGAGING, "engaging"},   {FORCE_WARM, "warm"},
    {FORCE_SLOW, "slow"},           {FORCE_OUTSIDE, "outside"},
    {FORCE_LET_GO, "let_go"},       {FORCE_OFF_OBJECT, "off_object"}};

void add_axes(std::string& head, std::string_view name, const std::string& unit)
{
    for (const char axis : {'x', 'y', 'z'})
        head.append(name).append("_").append(1, axis).append(unit.empty() ? "" : "_" + unit).append(",");
}

void add(std::string& line, const glm::dvec3& place)
{
    for (int axis = 0; axis < 3; ++axis)
        line.append(std::isfinite(place[axis]) ? digits_of(place[axis]) : std::string()).append(",");
}

}  // namespace

std::string flag_words(uint32_t flags)
{
    std::string words;
    for (const auto& [flag, word] : FLAG_WORDS)
        if ((flags & flag) != 0) words.append(words.empty() ? "" : "|").append(word);
    return words;
}

std::string tick_table_head(const std::string& unit)
{
    std::string head = "tick,time_s,read,buttons,";
    add_axes(head, "hand", "m");
    add_axes(head, "probe", unit);
    add_axes(head, "proxy", unit);
    add_axes(head, "force", "n");
    return head + "in_contact,relevant_share,objects,flags,energy_j\n";
}

std::string tick_table_line(const ReplayedTick& replayed, uint64_t tick, uint64_t begin_ns)
{
    const ForceStep& step = replayed.step;
    // Signed, since the clock of a trace may go backwards.
    const double time_s = 1e-9 * double(int64_t(replayed.now_ns - begin_ns));
    std::string line = std::to_string(tick) + ',' + digits_of(time_s) + ',';
    line.append(TRACE_READS[size_t(replayed.read)]).append(",").append(std::to_string(replayed.device.buttons));
    line += ',';
    add(line, replayed.device.position_m);
    add(line, step.probe);
    add(line, step.proxy);
    add(line, step.force_n);
    line.append(step.in_contact ? "1," : "0,").append(digits_of(step.relevant_share)).append(",");
    line.append(std::to_string(step.objects)).append(",").append(flag_words(step.flags)).append(",");
    return line.append(digits_of(replayed.energy_j)).append("\n");
}

TickTable::TickTable(const std::filesystem::path& path, const std::string& unit)
    : writer_(path), text_(tick_table_head(unit))
{}

void TickTable::add(const ReplayedTick& tick)
{
    constexpr size_t PIECE_BYTES = size_t(1) << 16;
    if (ticks_ == 0) begin_ns_ = tick.now_ns;
    text_ += tick_table_line(tick, ticks_++, begin_ns_);
    if (text_.size() >= PIECE_BYTES) flush();
}

void TickTable::commit()
{
    flush();
    writer_.commit();
}

void TickTable::flush()
{
    writer_.append(std::as_bytes(std::span(text_)));
    text_.clear();
}

}  // namespace shvr
