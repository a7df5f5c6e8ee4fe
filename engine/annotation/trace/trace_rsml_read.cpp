// Reads RSML (trace_rsml.cpp writes it): the metadata's unit and resolution, and for each root its polyline, its
// functions "diameter" and "group" (with the domain polyline, length or uniform), and its child roots. Other elements
// and attributes are ignored, since other programs write many. A nested root begins at the parent's node that lies at
// the root's first point or, without such a node, is joined to the parent's nearest node. All numbers are pixels
// (https://rootsystemml.github.io/format/metadata): `resolution` pixels make one `unit`. If the unit is "pixel", or
// neither is stated, a pixel is a voxel along x. A missing unit is the volume's, and a missing resolution is 1. Lengths
// are converted to the volume's unit. Without a diameter, the radius is one pixel. If the metadata state that positions
// are physical, these are converted once the whole file is read.

#include <algorithm>
#include <cmath>
#include <memory>

#include "engine/annotation/trace/trace_forms.h"
#include "engine/annotation/trace/trace_index.h"
#include "engine/annotation/trace/trace_xml.h"
#include "engine/base/error.h"
#include "engine/volume/unit.h"

namespace shvr {

namespace {

pugi::xml_node child_named(const pugi::xml_node& parent, std::string_view name)
{
    for (const pugi::xml_node& child : parent.children())
        if (name_of(child) == name) return child;
    return {};
}

/// The attribute "value", or else the text.
std::string value_of(const pugi::xml_node& node)
{
    const pugi::xml_attribute value = node.attribute("value");
    return std::string(trimmed(value ? value.value() : node.text().get()));
}

class RsmlReader {
public:
    RsmlReader(TraceReader& reader, const std::optional<TraceSpace>& volume) : reader_(reader), volume_(volume) {}

    void read(std::string_view text)
    {
        pugi::xml_document document;
        const pugi::xml_parse_result result = document.load_buffer(text.data(), text.size());
        const pugi::xml_node rsml = document.document_element();
        if (!result || name_of(rsml) != "rsml")
            fail(reader_.file(), ": cannot be read as RSML: ", result ? "it has no element rsml" : result.description(),
                 "; expected a complete XML document");
        read_metadata(child_named(rsml, "metadata"));
        const pugi::xml_node scene = child_named(rsml, "scene");
        if (!scene) fail(reader_.file(), ": has no element scene; expected one");
        for (const pugi::xml_node& plant : scene.children())
            if (name_of(plant) == "plant") read_plant(plant);
    }

private:
    /// A root's nodes along its polyline.
    struct Axis {
        std::optional<uint32_t> last;
        bool is_parent = false;
        TraceIndex index;  ///< all nodes by position, if nested roots need them
    };
    struct Waiting {
        pugi::xml_node root;
        std::shared_ptr<Axis> parent;  ///< null: a plant's own root
    };

    void read_metadata(const pugi::xml_node& metadata)
    {
        const std::string text(trimmed(child_named(metadata, "resolution").text().get()));
        const std::string unit = plain_unit(trimmed(child_named(metadata, "unit").text().get()));
        take_unit(unit.empty() && text.empty() ? "pixel" : unit);
        read_space(metadata);
        if (text.empty()) return;
        const std::optional<double> resolution = number_of(text);
        // Limits far beyond the resolution of any scan, yet such that computations cannot overflow.
        if (!resolution || !(*resolution >= 1e-12) || !(*resolution <= 1e12))
            fail(reader_.file(), ": metadata: resolution is ", in_quotes(text),
                 "; expected pixels to the unit, a number from 1e-12 to 1e12");
        pixels_per_unit_ = *resolution;
    }

    /// Keeps a unit that cannot be converted. It is refused later, unless it is the volume's unit.
    void take_unit(const std::string& unit)
    {
        const std::string lower = lower_case(unit);
        if (lower == "pixel" || lower == "pixels" || lower == "px") {
            if (volume_) per_unit_ = volume_->spacing.x;
            return;
        }
        if (unit.empty()) return;
        reader_.stated.unit = unit;
        if (!volume_ || unit == volume_->unit) return;
        const std::optional<double> from = micrometres_in(unit), to = micrometres_in(volume_->unit);
        if (!from || !to) return;
        per_unit_ = *from / *to;
        reader_.stated.unit = volume_->unit;
    }

    /// Metadata that we write (trace_rsml.cpp).
    void read_space(const pugi::xml_node& metadata)
    {
        const std::string where = reader_.file() + ": metadata";
        const auto text_of = [&](const char* name) {
            return std::string(trimmed(child_named(metadata, name).text().get()));
        };
        if (text_of("space") != "physical") return;
        for (const char* name : {"space", "frame", "origin", "directions"})
            if (const std::string text = text_of(name); !text.empty()) reader_.state(where, name, text);
        if (reader_.stated.origin) *reader_.stated.origin *= per_unit_;
        if (const std::string text = text_of("spacing"); !text.empty())
            reader_.stated.spacing = per_unit_ * reader_.spacing(where, text);
    }

    double length(double pixels) const { return pixels / pixels_per_unit_ * per_unit_; }

    /// Visits roots in document order, with a stack instead of recursion, since nesting may be deep.
    void read_plant(const pugi::xml_node& plant)
    {
        std::vector<Waiting> waiting;
        add_roots(plant, nullptr, waiting);
        while (!waiting.empty()) {
            const Waiting next = std::move(waiting.back());
            waiting.pop_back();
            const std::shared_ptr<Axis> axis = read_root(next.root, next.parent.get());
            add_roots(next.root, axis, waiting);
        }
    }

    static void add_roots(const pugi::xml_node& parent, const std::shared_ptr<Axis>& axis,
                          std::vector<Waiting>& waiting)
    {
        for (pugi::xml_node child = parent.last_child(); child; child = child.previous_sibling())
            if (name_of(child) == "root") waiting.push_back({child, axis});
    }

    /// The values of a function at the points of a polyline, at the distances `along` it; empty if there is no such
    /// function. The domains length and uniform are interpolated linearly; a group is taken from the nearer sample.
    std::vector<std::string> samples_of(const pugi::xml_node& root, const std::string& where, std::string_view name,
                                        const std::vector<double>& along)
    {
        std::vector<pugi::xml_node> functions;
        for (const pugi::xml_node& function : child_named(root, "functions").children())
            if (name_of(function) == "function" && function.attribute("name").value() == name)
                functions.push_back(function);
        const auto domain_of = [](const pugi::xml_node& function) {
            return std::string_view(function.attribute("domain").value());
        };
        // One value a point needs no interpolation.
        std::ranges::stable_partition(functions,
                                      [&](const auto& function) { return domain_of(function) == "polyline"; });
        for (const pugi::xml_node& function : functions) {
            const std::string_view domain = domain_of(function);
            std::vector<pugi::xml_node> samples;
            for (const pugi::xml_node& sample : function.children())
                if (name_of(sample) == "sample") samples.push_back(sample);
            std::vector<std::string> values;
            if (domain == "polyline" && samples.size() == along.size())
                for (const pugi::xml_node& sample : samples) values.push_back(value_of(sample));
            if (domain == "length" || domain == "uniform")
                values = values_along(samples, domain == "uniform", name != "group", along);
            if (!values.empty()) return values;
            reader_.read_past(Error(sentence(where, ": function ", in_quotes(name), " has ", samples.size(),
                                             " samples over the domain ", in_quotes(domain),
                                             "; expected one a point over \"polyline\", or samples of a number over "
                                             "\"length\" or \"uniform\"")),
                              "it is left out");
        }
        return {};
    }

    /// Returns an empty list if a sample's value or position is not a finite number.
    static std::vector<std::string> values_along(const std::vector<pugi::xml_node>& samples, bool is_uniform,
                                                 bool is_linear, const std::vector<double>& along)
    {
        std::vector<std::pair<double, double>> known;  // position, value
        for (const pugi::xml_node& sample : samples) {
            const std::optional<double> value = number_of(value_of(sample));
            const double share = samples.size() > 1 ? double(known.size()) / double(samples.size() - 1) : 0.0;
            const std::optional<double> position =
                is_uniform ? share * along.back() : number_of(trimmed(sample.attribute("position").value()));
            if (!value || !position || !std::isfinite(*value) || !std::isfinite(*position)) return {};
            known.emplace_back(*position, *value);
        }
        if (known.empty()) return {};
        std::ranges::stable_sort(known, {}, &std::pair<double, double>::first);
        std::vector<std::string> values;
        for (const double at : along) {
            const auto after = std::ranges::lower_bound(known, at, {}, &std::pair<double, double>::first);
            if (after == known.begin() || after == known.end()) {
                values.push_back(digits_of(after == known.end() ? known.back().second : after->second));
                continue;
            }
            const auto before = std::prev(after);
            const double t = (at - before->first) / (after->first - before->first);
            values.push_back(digits_of(is_linear ? (1.0 - t) * before->second + t * after->second
                                                 : (t < 0.5 ? before : after)->second));
        }
        return values;
    }

    /// Returns each point's distance along the polyline, in the file's unit. Malformed points are refused elsewhere.
    static std::vector<double> distances_along(const std::vector<pugi::xml_node>& points)
    {
        std::vector<double> along;
        glm::dvec3 last(0.0);
        for (const pugi::xml_node& point : points) {
            const glm::dvec3 at(point.attribute("x").as_double(), point.attribute("y").as_double(),
                                point.attribute("z").as_double());
            along.push_back(along.empty() ? 0.0 : along.back() + glm::length(at - last));
            last = at;
        }
        return along;
    }

    std::shared_ptr<Axis> read_root(const pugi::xml_node& root, Axis* parent)
    {
        const char* id = root.attribute("ID") ? root.attribute("ID").value() : root.attribute("id").value();
        const std::string where = reader_.file() + ": root " + in_quotes(id);
        const pugi::xml_node polyline = child_named(child_named(root, "geometry"), "polyline");
        std::vector<pugi::xml_node> points;
        for (const pugi::xml_node& point : polyline.children())
            if (name_of(point) == "point") points.push_back(point);
        if (points.empty()) fail(where, ": has no geometry with a polyline of points; expected one");
        const std::vector<double> along = distances_along(points);
        const std::vector<std::string> diameters = samples_of(root, where, "diameter", along);
        const std::vector<std::string> groups = samples_of(root, where, "group", along);
        const std::string group = group_of(root);
        const auto axis = std::make_shared<Axis>();
        axis->is_parent = bool(child_named(root, "root"));
        for (size_t i = 0; i < points.size(); ++i) {
            TraceNode node{position_of(where, points[i]), length(1.0),
                           reader_.group(where, groups.empty() ? group : groups[i])};
            if (!diameters.empty()) node.radius = length(0.5 * reader_.radius(where, diameters[i]));
            add_point(where, node, i == 0 ? parent : nullptr, *axis);
        }
        return axis;
    }

    /// Adds a point of a root. Only the first point of a root nested in another root has a `parent`.
    void add_point(const std::string& where, const TraceNode& node, Axis* parent, Axis& axis)
    {
        std::optional<uint32_t> number;
        if (parent) {
            axis.last = parent->index.nearest(node.position);
            if (reader_.trace.node(*axis.last).position == node.position) number = axis.last;
        }
        if (!number) {
            number = reader_.add_node(where, node);
            if (axis.last) reader_.add_internode(where, {*axis.last, *number, node.group});
        }
        axis.last = number;
        if (axis.is_parent) axis.index.set(*number, node.position);
    }

    static std::string group_of(const pugi::xml_node& root)
    {
        const std::string group = value_of(child_named(child_named(root, "properties"), "group"));
        return group.empty() ? "1" : group;
    }

    glm::dvec3 position_of(const std::string& where, const pugi::xml_node& point) const
    {
        const auto coordinate = [&](const char* name, const char* otherwise) {
            return length(reader_.coordinate(where, name, point.attribute(name).as_string(otherwise)));
        };
        return {coordinate("x", ""), coordinate("y", ""), coordinate("z", "0")};
    }

    TraceReader& reader_;
    const std::optional<TraceSpace>& volume_;
    double pixels_per_unit_ = 1.0;
    double per_unit_ = 1.0;  ///< the volume's units per unit of the file
};

}  // namespace

void read_trace_rsml(TraceReader& reader, std::string_view text, const std::optional<TraceSpace>& volume)
{
    RsmlReader(reader, volume).read(text);
}

}  // namespace shvr
