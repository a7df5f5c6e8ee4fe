// Writes operations as lines of a script: the inverse of script.cpp.

#include "engine/annotation/script/script.h"
#include "engine/base/text.h"
#include "engine/session/fields.h"

namespace shvr {

namespace {

std::string text_of(const glm::dvec3& point)
{
    return sentence('[', digits_of(point.x), ',', digits_of(point.y), ',', digits_of(point.z), ']');
}

/// A line of JSON, built key by key. Keys and texts are plain words, so they need no escaping.
class Line {
public:
    explicit Line(std::string_view op) : text_(sentence("{\"op\":\"", op, '"')) {}
    Line& raw(std::string_view key, const std::string& value)
    {
        text_ += sentence(",\"", key, "\":", value);
        return *this;
    }
    Line& word(std::string_view key, std::string_view value) { return raw(key, sentence('"', value, '"')); }
    Line& whole(std::string_view key, int64_t value) { return raw(key, sentence(value)); }
    Line& number(std::string_view key, double value) { return raw(key, digits_of(value)); }
    Line& number(std::string_view key, const std::optional<double>& value)
    {
        return value ? number(key, *value) : *this;
    }
    Line& point(std::string_view key, const glm::dvec3& value) { return raw(key, text_of(value)); }
    operator std::string() const { return text_ + "}"; }

private:
    std::string text_;
};

std::string text_of(const std::vector<glm::dvec3>& path)
{
    std::string text;
    for (const glm::dvec3& point : path) text += (text.empty() ? "[" : ",") + text_of(point);
    return text + "]";
}

template <class Counts>
std::string text_of_counts(const Counts& counts)
{
    std::string text;
    for (const auto& [group, count] : counts) text += sentence(text.empty() ? "{" : ",", '"', int(group), "\":", count);
    return text.empty() ? "{}" : text + "}";
}

std::string line(const PaintOp& op)
{
    Line line(op.density ? "density" : "paint");
    line.word("brush", spelled(op.brush)).word("region", spelled(op.region));
    if (op.paints_group) line.whole("group", op.group);
    line.number("threshold", op.threshold).number("radius", op.radius_voxels).whole("connectivity", op.connectivity);
    if (op.density) {
        line.word("falloff", spelled(op.density->falloff));
        line.number("offset", op.density->offset);
    }
    if (op.only_unpainted) line.raw("only_unpainted", "true");
    return line.raw("path", text_of(op.path));
}

std::string line(const NodeOp& op)
{
    Line line("node");
    line.point("at", op.at).number("radius", op.radius_voxels);
    if (op.group) line.whole("group", *op.group);
    if (op.divides) line.whole("divides", *op.divides);
    return line;
}

std::string line(const SelectOp& op)
{
    Line line("select");
    if (op.near)
        line.point(op.is_internode ? "near_internode" : "near", *op.near);
    else
        line.whole(op.is_internode ? "internode" : "node", op.number.value_or(0));
    return line.number("within", op.within_voxels);
}

std::string line(const LinkOp& op)
{
    Line line("link");
    if (op.near)
        line.point("near", *op.near);
    else
        line.whole("node", op.node.value_or(0));
    return line.number("within", op.within_voxels);
}

std::string line(const RadiusOp& op)
{
    Line line("radius");
    if (op.of != RadiusOp::Of::selected)
        line.whole("group", op.group).word("of", op.of == RadiusOp::Of::nodes ? "nodes" : "internodes");
    return op.radius_voxels ? line.number("radius", *op.radius_voxels) : line.raw("radius", "null");
}

std::string line(const ExpectOp& op)
{
    Line line("expect");
    if (!op.voxels_in_group.empty()) line.raw("voxels_in_group", text_of_counts(op.voxels_in_group));
    if (op.voxels_with_offset) line.whole("voxels_with_offset", *op.voxels_with_offset);
    if (op.nodes) line.whole("nodes", *op.nodes);
    if (op.internodes) line.whole("internodes", *op.internodes);
    return line;
}

/// Writes an operation on groups. The keys are those that its row of the operation table visits.
template <class Op>
requires IS_GROUP_OPERATION<Op> std::string line(const Op& op)
{
    std::string id = row_of(GroupOperation(op)).id;
    return write_fields({}, [&, written = op](Fields& f) mutable {
        f.text("op", id, {});
        operation_fields(f, written);
    });
}

std::string line(const SelectSegmentOp&)
{
    return Line("select_segment");
}
std::string line(const DeselectOp&)
{
    return Line("deselect");
}
std::string line(const MoveOp& op)
{
    Line line("move");
    line.point("to", op.to);
    if (op.from) line.point("from", *op.from);
    return line;
}
std::string line(const DeleteOp&)
{
    return Line("delete");
}
std::string line(const GroupOp& op)
{
    return Line("group").whole("group", op.group);
}
std::string line(const UndoOp& op)
{
    return Line("undo").whole("count", op.count);
}
std::string line(const RedoOp& op)
{
    return Line("redo").whole("count", op.count);
}
std::string line(const SaveOp&)
{
    return Line("save");
}
std::string line(const RevertOp&)
{
    return Line("revert");
}

}  // namespace

std::string line_of(const ScriptOp& op)
{
    return std::visit([](const auto& each) { return line(each); }, op);
}

}  // namespace shvr
