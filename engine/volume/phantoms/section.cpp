// A phantom of a part of a flower head between its centre and its rim, as in the thesis's study (chapter 6): adaxial
// veins that run outwards (x), veins that descend to them from the florets (z), joins between these two kinds, and
// bundles that are joined to neither. Positions are fractions of the volume's shortest side.

#include <array>
#include <cmath>

#include "engine/volume/phantoms/phantom_model.h"

namespace shvr {

namespace {

enum SectionRandom : uint32_t { PLACES = 71, RADII };
constexpr uint8_t SECTION_ADAXIAL = 2, SECTION_FLORET = 3, SECTION_SEPARATE = 4;
constexpr double MIN_RADIUS = 0.0130, MAX_RADIUS = 0.0210;
/// Radii of nodes relative to the vein. In the thesis, nodes have the size of the probe, and some are wider than the
/// vein (4.1.2, 6.2). These factors reproduce that truth's scores (table 6.1): .971 for nodes, 1 for internodes.
constexpr double WIDE_NODE = 1.105, NODE = 0.88;
/// Separate bundles are joined to no others. To fill 29.9 % of all bundles' voxels, which gives a Dice score of .824,
/// the square of their radius is this fraction of the other bundles' volume / (pi side).
constexpr double SEPARATE_SHARE = 0.1527;

class Section {
public:
    explicit Section(const PhantomSpec& spec)
        : spec_(spec),
          scale_(double(std::min({spec.size.x, spec.size.y, spec.size.z}))),
          corner_(0.5 * (glm::dvec3(spec.size) - scale_))
    {}

    PhantomModel make()
    {
        add_adaxial();
        add_joins();
        add_florets();
        add_separate();
        if (spec_.double_tubes) {
            const glm::dvec3 above = corner_ + scale_ * glm::dvec3(0.5, 0.5, 5.0);
            for (const Tube& tube : std::vector(model_.tubes))
                if (tube.group != 0) add_phloem(model_, tube, above);
        }
        model_.sections = {{"adaxial", SECTION_ADAXIAL}, {"floret", SECTION_FLORET}, {"separate", SECTION_SEPARATE}};
        model_.group_of_separate = SECTION_SEPARATE;
        model_.tissues = {{"receptacle", RECEPTACLE}, {"floret body", FLORET_BODY}};
        model_.tissue = [corner = corner_, scale = scale_, blur = spec_.flaws.blur](const glm::dvec3& voxel) {
            const double above = (voxel.z - corner.z) - 0.86 * scale;
            const double air = (voxel.z - corner.z) - 0.92 * scale;
            const double tissue = GROUND_TISSUE + (RECEPTACLE_TISSUE - GROUND_TISSUE) * cover_of(-above, blur);
            return Tissue{tissue + (AIR - tissue) * cover_of(-air, blur),
                          above >= 0.0 && air < 0.0 ? RECEPTACLE : uint8_t{0}};
        };
        return std::move(model_);
    }

private:
    static constexpr size_t VEINS = 3;

    double random(SectionRandom purpose, size_t index) const
    {
        return random_unit(spec_.seed, purpose, uint32_t(index));
    }
    /// Adds a node at `place`, in fractions of the side. Its radius differs from the tube's radius there (`veins_`).
    size_t add_node(const glm::dvec3& place, uint8_t group, bool is_wide)
    {
        const double radius = scale_ * (MIN_RADIUS + (MAX_RADIUS - MIN_RADIUS) * random(RADII, model_.nodes.size()));
        veins_.push_back(radius);
        return model_.add_node(corner_ + scale_ * place, radius * (is_wide ? WIDE_NODE : NODE), group);
    }
    void link(size_t from, size_t to, uint8_t group)
    {
        model_.links.push_back({from, to});
        model_.tubes.push_back({.ends = {model_.nodes[from].voxel, model_.nodes[to].voxel},
                                .radii = {veins_[from], veins_[to]},
                                .group = group,
                                .intensity = {VEIN, VEIN}});
    }
    /// Adds a segment with `inner` nodes between two nodes. One of them is wide: the second of three, else the first.
    void add_segment(size_t from, size_t to, int inner, uint8_t group, const glm::dvec3& bend)
    {
        const glm::dvec3 a = (model_.nodes[from].voxel - corner_) / scale_;
        const glm::dvec3 b = (model_.nodes[to].voxel - corner_) / scale_;
        size_t previous = from;
        for (int i = 1; i <= inner; ++i) {
            const double t = double(i) / double(inner + 1);
            const size_t node = add_node(a + (b - a) * t + bend * (4.0 * t * (1.0 - t)), group, i == (inner + 1) / 2);
            link(previous, node, group);
            previous = node;
        }
        link(previous, to, group);
    }
    void add_separate_tube(const glm::dvec3& from, const glm::dvec3& to, double radius)
    {
        model_.tubes.push_back({.ends = {corner_ + scale_ * from, corner_ + scale_ * to},
                                .radii = {radius, radius},
                                .group = SECTION_SEPARATE,
                                .intensity = {VEIN, VEIN}});
    }

    void add_adaxial();
    void add_joins();
    void add_florets();
    void add_separate();

    const PhantomSpec& spec_;
    double scale_;  ///< voxels
    glm::dvec3 corner_;
    PhantomModel model_;
    std::vector<double> veins_;                     ///< radius of the vein (not the node) at each node
    std::array<std::vector<size_t>, VEINS> stops_;  ///< nodes of each adaxial vein: ends and branches, going outwards
};

void Section::add_adaxial()
{
    const std::array<std::vector<double>, VEINS> stops = {{{0.07, 0.20, 0.40, 0.60, 0.80, 0.93},
                                                           {0.07, 0.25, 0.37, 0.50, 0.65, 0.80, 0.93},
                                                           {0.07, 0.30, 0.50, 0.70, 0.84, 0.93}}};
    for (size_t vein = 0; vein < VEINS; ++vein) {
        const double y = 0.24 + 0.26 * double(vein) + 0.03 * (random(PLACES, vein) - 0.5);
        const auto place = [&](double x) { return glm::dvec3(x, y + 0.04 * x * (1.0 - x), 0.40 - 0.10 * x * x); };
        for (const double x : stops[vein]) stops_[vein].push_back(add_node(place(x), SECTION_ADAXIAL, false));
        for (size_t i = 0; i + 1 < stops_[vein].size(); ++i)
            add_segment(stops_[vein][i], stops_[vein][i + 1], i == 0 ? 2 : 1, SECTION_ADAXIAL, glm::dvec3(0.0));
    }
}

/// Four between neighbours, which close two loops.
void Section::add_joins()
{
    const glm::dvec3 down(0.0, 0.0, -0.04);
    add_segment(stops_[0][1], stops_[1][1], 2, SECTION_ADAXIAL, down);
    add_segment(stops_[0][3], stops_[1][4], 2, SECTION_ADAXIAL, down);
    add_segment(stops_[1][2], stops_[2][1], 2, SECTION_ADAXIAL, down);
    add_segment(stops_[1][5], stops_[2][3], 2, SECTION_ADAXIAL, down);
}

/// Adds the bodies of the florets, which stand on the receptacle and belong to no colour group.
void Section::add_florets()
{
    const std::array<std::array<size_t, 2>, 6> below = {{{0, 2}, {0, 4}, {1, 3}, {1, 5}, {2, 2}, {2, 4}}};
    for (const auto& [vein, stop] : below) {
        const size_t joint = stops_[vein][stop];
        const glm::dvec3 at = (model_.nodes[joint].voxel - corner_) / scale_;
        const glm::dvec3 top(at.x - 0.04, at.y + 0.05, 0.82);
        const size_t end = add_node(top, SECTION_FLORET, false);
        add_segment(joint, end, 3, SECTION_FLORET, glm::dvec3(0.03, 0.0, 0.0));
        model_.tubes.push_back({.ends = {corner_ + scale_ * (top + glm::dvec3(0.0, 0.0, 0.06)),
                                         corner_ + scale_ * (top + glm::dvec3(0.0, 0.0, 0.14))},
                                .radii = {0.028 * scale_, 0.022 * scale_},
                                .tissue = FLORET_BODY,
                                .intensity = {DERMAL_TISSUE, DERMAL_TISSUE}});
    }
}

/// Adds bundles joined to no others: abaxial veins at the bottom, and three florets' veins that end in ground tissue:
/// one isolated, one 1.5 voxels from another vein, and one overlapping another by half of its radius.
void Section::add_separate()
{
    double joined = 0.0;
    for (const auto& [from, to] : model_.links) {
        const glm::dvec3 d = model_.nodes[to].voxel - model_.nodes[from].voxel;
        const double a = veins_[from], b = veins_[to];
        joined += std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z) * (a * a + a * b + b * b) / 3.0;
    }
    const double radius = std::sqrt(SEPARATE_SHARE * joined / scale_);
    for (const double y : {0.36, 0.66})
        add_separate_tube({0.06, y, 0.16}, {0.94, y + 0.02 * (random(PLACES, VEINS) - 0.5), 0.10}, radius);
    add_separate_tube({0.62, 0.12, 0.82}, {0.60, 0.10, 0.46}, radius);
    // Adds a tube next to the upper half of a floret's vein; `apart`: distance between their surfaces in voxels.
    const auto next_to = [&](size_t link, double apart) {
        const auto& [from, to] = model_.links[link];
        const double away = (std::max(veins_[from], veins_[to]) + radius + apart) / scale_;
        const glm::dvec3 a = (model_.nodes[from].voxel - corner_) / scale_,
                         b = (model_.nodes[to].voxel - corner_) / scale_;
        const glm::dvec3 out(0.0, away, 0.0);
        add_separate_tube(a + out, b + out, radius);
        add_separate_tube(a + out, a + out + glm::dvec3(0.02, 0.05, -0.16), radius);
    };
    const size_t links = model_.links.size();
    next_to(links - 4 * 3 - 1, 1.5);
    next_to(links - 4 * 1 - 1, -0.5 * radius);
}

}  // namespace

PhantomModel make_section(const PhantomSpec& spec)
{
    return Section(spec).make();
}

}  // namespace shvr
