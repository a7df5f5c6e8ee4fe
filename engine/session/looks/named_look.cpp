#include "engine/session/looks/named_look.h"

#include <algorithm>

#include "engine/base/file.h"
#include "engine/session/session_keys.h"

namespace shvr {

namespace {

constexpr int64_t MAX_FILE_BYTES = 1 << 20;
constexpr size_t MAX_POINTS = 4096;
constexpr double MAX_PLACE = 1e6;  ///< as in files of transfer functions

struct CurvePoint {
    ControlPoint point;
};
void fields(Fields& f, CurvePoint& each)
{
    f.number("at", each.point.intensity, {-MAX_PLACE, MAX_PLACE}, {.is_required = true});
    f.color("color", each.point.color, {});
    f.number("opacity", each.point.opacity, SHARE, {.is_required = true});
}

void fields(Fields& f, TransferPreset& curve)
{
    std::vector<CurvePoint> points;
    for (const ControlPoint& point : curve.points) points.push_back({point});
    f.flag("extends", curve.extends, {});
    f.list("points", points, MAX_POINTS, {.is_required = true});
    curve.points.clear();
    for (const CurvePoint& each : points) curve.points.push_back(each.point);
    f.check("points", curve.points.size() >= 2, "at least two points");
    f.check("points", std::ranges::is_sorted(curve.points, {}, &ControlPoint::intensity),
            "points in the order of `at`");
}

void fields(Fields& f, NamedLook& look)
{
    int64_t version = 1;
    f.whole("shvr_look", version, 1, 1, {.is_required = true});
    f.section("transfer_function", [&](Fields& inner) { fields(inner, look.curve); }, {.is_required = true});
    f.section("light", look.light, {.is_required = true});
    shvr::fields(f, look.groups);
}

}  // namespace

NamedLook look_of(const Session& session, const std::string& name, const VolumeStatistics& statistics)
{
    NamedLook look{.name = name,
                   .curve = preset_of(session.transfer_function, name, statistics),
                   .groups = session.groups,
                   .light = session.light};
    for (auto& [number, group] : look.groups) group.visible = !(group.locked = false);
    return look;
}

Session with_look(Session session, const NamedLook& look, const VolumeStatistics& statistics)
{
    session.transfer_function = transfer_function_of(look.curve, statistics);
    session.light = look.light;
    for (const auto& [number, group] : look.groups) {
        GroupSettings& here = session.groups[number];
        const bool is_visible = here.visible, is_locked = here.locked;
        here = group;
        here.visible = is_visible;
        here.locked = is_locked;
    }
    if (const std::optional<uint8_t> group = group_in_cycle(session.groups))
        fail("the look ", look.name, " makes group ", int{*group},
             " a part of itself; expected parents that fit those of the open scan: remove the parent of that group");
    return session;
}

std::string text_of(const NamedLook& look)
{
    NamedLook written = look;  // a copy, because fields take mutable objects
    return write_fields({}, [&](Fields& f) { fields(f, written); }) + "\n";
}

NamedLook parse_look(const std::string& text, const std::string& name, const std::string& origin)
{
    const JsonDocument json(text, origin, {.expected = "a look"});
    NamedLook look{.name = name, .curve = {.name = name, .note = {}, .points = {}}, .groups = {}, .light = {}};
    read_fields(json.root(), {}, [&](Fields& f) { fields(f, look); });
    return look;
}

bool is_look(const std::string& text, const std::string& origin)
{
    const JsonDocument json(text, origin, {.expected = "a look or a transfer function"});
    return json.root()["shvr_look"].exists();
}

NamedLook read_look(const std::filesystem::path& file)
{
    return parse_look(read_text(file, MAX_FILE_BYTES), file.stem().string(), file.string());
}

std::vector<NamedLook> looks_in(const std::filesystem::path& folder, std::vector<std::string>& warnings)
{
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (const std::filesystem::directory_entry& entry : std::filesystem::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".json") files.push_back(entry.path());
    std::ranges::sort(files);
    std::vector<NamedLook> looks;
    for (const std::filesystem::path& file : files) {
        try {
            looks.push_back(read_look(file));
        } catch (const Error& error) {
            warnings.emplace_back(error.what());
        }
    }
    return looks;
}

std::filesystem::path look_file(const std::filesystem::path& folder, const std::string& name)
{
    if (const std::string why = why_no_name(name, "look"); !why.empty()) fail(why);
    return folder / (name + ".json");
}

}  // namespace shvr
