// A phantom of a flower head: stem bundles that continue as abaxial veins along the bowl and into the bracts, adaxial
// veins below the receptacle, and veins that descend from florets.

#include <cmath>
#include <optional>

#include "engine/base/error.h"
#include "engine/volume/phantoms/capitulum_form.h"
#include "engine/volume/phantoms/phantom_model.h"
#include "engine/volume/procedural/turns.h"

namespace shvr {

namespace {

enum CapitulumRandom : uint32_t { SPOKES = 51, WAVES, JOINS, BUNDLES };
constexpr int STEM_BUNDLES = 13;
constexpr double STEM_RADIUS = 0.16, STEM_BOTTOM = -1.1;

class Capitulum {
public:
    Capitulum(const PhantomSpec& spec, const CapitulumSpecies& species, const CapitulumStage& stage)
        : spec_(spec),
          species_(species),
          stage_(stage),
          middle_(0.5 * glm::dvec3(spec.size)),
          scale_(0.40 * double(std::min({spec.size.x, spec.size.y, spec.size.z})))
    {}

    PhantomModel make()
    {
        add_abaxial();
        if (stage_.adaxial_from < stage_.adaxial_to) {
            if (species_.pattern == AdaxialPattern::net)
                add_net();
            else
                add_spokes();
        }
        add_florets();
        if (spec_.double_tubes) {
            const glm::dvec3 top = middle_ + glm::dvec3(0.0, 0.0, scale_ * species_.rim);
            for (const auto& [from, to] : std::vector(model_.links)) {
                const ProceduralTruth::Node &a = model_.nodes[from], &b = model_.nodes[to];
                add_phloem(model_,
                           {.ends = {a.voxel, b.voxel}, .radii = {a.radius_voxels, b.radius_voxels}, .group = b.group},
                           top);
            }
        }
        model_.sections = {{"abaxial", ABAXIAL}, {"adaxial", ADAXIAL}, {"floret", FLORET}};
        model_.tissues = {{"dermal", DERMAL}, {"receptacle", RECEPTACLE}};
        model_.tissue = tissue();
        model_.facts = facts();
        return std::move(model_);
    }

private:
    struct Vein {
        size_t node;
        double rho;
    };

    glm::dvec3 place(double turns, double rho, double height) const
    {
        const glm::dvec2 direction = direction_of(turns);
        return middle_ + scale_ * glm::dvec3(rho * direction.x, rho * direction.y, height);
    }
    double radius(double of_head) const { return std::max(1.0, of_head * scale_); }
    double random(CapitulumRandom purpose, int index, int of = 0) const
    {
        return random_unit(spec_.seed, purpose, uint32_t(index), uint32_t(of));
    }
    double adaxial_from() const { return std::max(species_.adaxial_inner, stage_.adaxial_from); }
    bool reaches_axis() const { return species_.adaxial_inner < 0.2; }

    void add_abaxial();
    void add_bract(double turns, size_t base, size_t tip);
    void add_spokes();
    void add_joins(const std::vector<std::vector<Vein>>& spokes);
    void add_net();
    void add_florets();
    void add_floret(int k);
    std::function<Tissue(const glm::dvec3&)> tissue() const;
    std::map<std::string, std::vector<double>> facts() const;

    std::optional<size_t> nearest(const std::vector<Vein>& veins, const glm::dvec3& voxel) const
    {
        std::optional<size_t> nearest;
        double least = 0.0;
        for (const Vein& vein : veins) {
            const glm::dvec3 d = model_.nodes[vein.node].voxel - voxel;
            const double squared = d.x * d.x + d.y * d.y + d.z * d.z;
            if (nearest && squared >= least) continue;
            nearest = vein.node;
            least = squared;
        }
        return nearest;
    }

    const PhantomSpec& spec_;
    const CapitulumSpecies& species_;
    const CapitulumStage& stage_;
    glm::dvec3 middle_;
    double scale_;  ///< voxels of the head's radius
    PhantomModel model_;
    std::vector<Vein> abaxial_rim_, adaxial_;
    std::vector<Vein> floret_roots_;  ///< lower ends of florets' veins
};

void Capitulum::add_abaxial()
{
    const double thick = radius(0.030);
    for (int i = 0; i < STEM_BUNDLES; ++i) {
        const double turns = (double(i) + 0.3 * (random(BUNDLES, i) - 0.5)) / STEM_BUNDLES;
        size_t node = model_.add_node(place(turns, STEM_RADIUS, STEM_BOTTOM), thick, ABAXIAL);
        for (const double height : {-0.9, -0.72, -0.6})
            node = model_.add_next(node, place(turns, STEM_RADIUS, height), thick, ABAXIAL);
        for (const double rho : {0.25, 0.38, 0.5, 0.62, 0.72, 0.8, 0.88, 0.94, 0.98}) {
            node = model_.add_next(node, place(turns, rho, abaxial_height(species_, rho)), thick, ABAXIAL);
            if (rho > 0.85 && rho < 0.95) abaxial_rim_.push_back({node, rho});
        }
        const size_t base = node;
        for (const glm::dvec2& bract : stage_.bract)
            node = model_.add_next(node, place(turns, bract.x, species_.rim + bract.y), thick, ABAXIAL);
        add_bract(turns, base, node);
    }
}

/// Adds the leaf around a bract's vein from `base` to `tip`, made of three flat strips in a row.
void Capitulum::add_bract(double turns, size_t base, size_t tip)
{
    const glm::dvec2 out = direction_of(turns);
    const glm::dvec3 across(-out.y, out.x, 0.0);
    const double thick = radius(0.045), thin = radius(0.03);
    for (const double side : {-1.0, 0.0, 1.0})
        for (size_t node = base; node < tip; ++node) {
            const auto edge = [&](size_t at) {
                return model_.nodes[at].voxel + side * (at == tip ? 0.4 : 1.0) * 0.07 * scale_ * across;
            };
            model_.tubes.push_back({.ends = {edge(node), edge(node + 1)},
                                    .radii = {thick, node + 1 == tip ? thin : thick},
                                    .tissue = DERMAL,
                                    .intensity = {DERMAL_TISSUE, DERMAL_TISSUE}});
        }
}

/// Adds the adaxial veins. Each runs inwards from its outer end, straight or in waves.
void Capitulum::add_spokes()
{
    const double thick = radius(0.024);
    const bool is_joined = species_.pattern == AdaxialPattern::joined;
    std::vector<std::vector<Vein>> spokes;
    for (int i = 0; i < species_.spokes; ++i) {
        const double turns = (double(i) + 0.2 * (random(SPOKES, i) - 0.5)) / species_.spokes;
        const double phase = random(WAVES, i);
        // In the pattern `joined`, every second vein ends half-way, where it joins its neighbour.
        const double from = is_joined && i % 2 == 1 ? std::max(0.34, adaxial_from()) : adaxial_from();
        std::vector<Vein> spoke;
        constexpr int PIECES = 8;
        for (int piece = 0; piece <= PIECES; ++piece) {
            const double rho = stage_.adaxial_to + (from - stage_.adaxial_to) * piece / PIECES;
            const double wave = is_joined ? 0.015 * direction_of(phase + 1.5 * rho).y : 0.0;
            const glm::dvec3 at = place(turns + wave, rho, adaxial_height(species_, rho));
            const size_t node = piece == 0 ? model_.add_node(at, thick, ADAXIAL)
                                           : model_.add_next(spoke.back().node, at, thick, ADAXIAL);
            spoke.push_back({node, rho});
        }
        if (stage_.joins_between)
            if (const auto rim = nearest(abaxial_rim_, model_.nodes[spoke[0].node].voxel))
                model_.link(*rim, spoke[0].node);
        adaxial_.insert(adaxial_.end(), spoke.begin(), spoke.end());
        spokes.push_back(std::move(spoke));
    }
    if (is_joined) add_joins(spokes);
}

void Capitulum::add_joins(const std::vector<std::vector<Vein>>& spokes)
{
    const auto count = spokes.size();
    for (size_t i = 0; i < count; ++i) {
        const std::vector<Vein>& next = spokes[(i + 1) % count];
        if (i % 2 == 1) {  // its inner end
            std::vector<Vein> inner;
            for (const Vein& vein : next)
                if (vein.rho < spokes[i].back().rho) inner.push_back(vein);
            if (const auto at = nearest(inner, model_.nodes[spokes[i].back().node].voxel))
                model_.link(spokes[i].back().node, *at);
        }
        for (size_t piece = 1; piece + 2 < spokes[i].size(); ++piece)
            if (random(JOINS, int(i), int(piece)) < 0.3) model_.link(spokes[i][piece].node, next[piece + 1].node);
    }
}

/// Adds a node below each floret, and joins it to the two nearest nodes further out on the floret's parastichies.
void Capitulum::add_net()
{
    const double thick = radius(0.024);
    const std::vector<int> steps = parastichy_steps(spec_);
    std::vector<std::optional<size_t>> nodes(static_cast<size_t>(spec_.florets));
    for (int k = 0; k < spec_.florets; ++k) {
        const auto [turns, rho] = floret_place(spec_, k);
        if (rho < adaxial_from() || rho > stage_.adaxial_to) continue;
        nodes[size_t(k)] = model_.add_node(place(turns, rho, adaxial_height(species_, rho)), thick, ADAXIAL);
        adaxial_.push_back({*nodes[size_t(k)], rho});
    }
    for (int k = 0; k < spec_.florets; ++k) {
        if (!nodes[size_t(k)]) continue;
        std::vector<std::pair<double, size_t>> later;
        for (const int step : steps) {
            if (k + step >= spec_.florets || !nodes[size_t(k + step)]) continue;
            const size_t node = *nodes[size_t(k + step)];
            const glm::dvec3 d = model_.nodes[node].voxel - model_.nodes[*nodes[size_t(k)]].voxel;
            later.emplace_back(d.x * d.x + d.y * d.y + d.z * d.z, node);
        }
        std::ranges::sort(later);
        for (size_t i = 0; i < std::min<size_t>(2, later.size()); ++i) model_.link(*nodes[size_t(k)], later[i].second);
    }
    if (!stage_.joins_between) return;
    // The outermost parastichies join the abaxial veins below them.
    for (const Vein& rim : abaxial_rim_) {
        if (rim.rho > 0.9) continue;
        if (const auto net = nearest(adaxial_, model_.nodes[rim.node].voxel)) model_.link(rim.node, *net);
    }
}

void Capitulum::add_florets()
{
    // Adds florets from the rim inwards, since veins near the axis join veins further out.
    for (int k = spec_.florets - 1; k >= 0; --k)
        if (floret_place(spec_, k).rho >= stage_.florets_from) add_floret(k);
}

void Capitulum::add_floret(int k)
{
    const auto [turns, rho] = floret_place(spec_, k);
    const double thick = radius(0.018);
    const double surface = receptacle_height(species_, rho);
    // Florets mature from the rim inwards, so the veins of florets near the middle are faint.
    const double maturity = std::clamp((rho - stage_.florets_from) / 0.5, 0.0, 1.0);
    const double seen = GROUND_TISSUE + (VEIN - GROUND_TISSUE) * (0.5 + 0.5 * maturity);
    const double body = 0.55 / std::sqrt(double(spec_.florets));
    model_.tubes.push_back({.ends = {place(turns, rho, surface + 0.03 + body),
                                     place(turns, rho, surface + 0.03 + body + 0.10 * (0.3 + maturity))},
                            .radii = {radius(body), radius(0.8 * body)},
                            .group = FLORET,
                            .intensity = {DERMAL_TISSUE, DERMAL_TISSUE}});
    const size_t top = model_.add_node(place(turns, rho, surface + 0.03), thick, FLORET);
    const size_t root = model_.add_next(top, place(turns, rho, surface - 0.045), thick, FLORET, seen);
    const glm::dvec3 at = model_.nodes[root].voxel;
    std::optional<size_t> joint;
    if (rho >= RIM_FROM) {
        if (stage_.joins_rim) joint = nearest(abaxial_rim_, at);
    } else if (stage_.joins_between) {
        const bool is_middle = rho < adaxial_from() && !reaches_axis();
        joint = nearest(is_middle ? floret_roots_ : adaxial_, at);
    }
    if (joint) model_.link(*joint, root, seen, seen);
    floret_roots_.push_back({root, rho});
}

/// Returns a function for the tissue: ground tissue inside head and stem, a dermal layer on the surface, air outside.
std::function<Tissue(const glm::dvec3&)> Capitulum::tissue() const
{
    return [species = species_, middle = middle_, scale = scale_, blur = spec_.flaws.blur](const glm::dvec3& voxel) {
        const glm::dvec3 p = (voxel - middle) / scale;
        const double rho = std::sqrt(p.x * p.x + p.y * p.y);
        const double below_top = receptacle_height(species, rho) - p.z;
        const double above_bowl = p.z - (abaxial_height(species, rho) - 0.08);
        const double head = std::min({below_top, above_bowl, 1.0 - rho});
        const double stem =
            std::min({STEM_RADIUS + 0.08 - rho, p.z - (STEM_BOTTOM - 0.05), receptacle_height(species, 0.0) - p.z});
        const double depth = std::max(head, stem);
        const double receptacle = depth == head && below_top < 0.045 ? RECEPTACLE_TISSUE : GROUND_TISSUE;
        const double inside = cover_of(scale * (0.02 - depth), blur);
        const bool is_receptacle = receptacle == RECEPTACLE_TISSUE;
        return Tissue{
            AIR + cover_of(-scale * depth, blur) * (DERMAL_TISSUE + inside * (receptacle - DERMAL_TISSUE) - AIR),
            depth < 0.0     ? uint8_t{0}
            : depth < 0.02  ? DERMAL
            : is_receptacle ? RECEPTACLE
                            : uint8_t{0}};
    };
}

std::map<std::string, std::vector<double>> Capitulum::facts() const
{
    return {{"axis_through_voxels", {middle_.x, middle_.y, middle_.z}},
            {"axis_direction", {0.0, 0.0, 1.0}},
            {"head_radius_voxels", {scale_}},
            {"divergence_degrees", {360.0 * divergence_turns(spec_)}},
            {"jugacy", {spec_.phyllotaxis == "bijugate" ? 2.0 : 1.0}},
            {"handedness", {spec_.left_handed ? -1.0 : 1.0}},
            {"florets", {double(spec_.florets)}}};
}

}  // namespace

std::vector<std::string> capitulum_species()
{
    std::vector<std::string> names;
    for (const CapitulumSpecies& species : CAPITULUM_SPECIES) names.emplace_back(species.name);
    return names;
}

PhantomModel make_capitulum(const PhantomSpec& spec)
{
    const auto* species = std::ranges::find(CAPITULUM_SPECIES, spec.species, &CapitulumSpecies::name);
    if (species == std::end(CAPITULUM_SPECIES))
        fail("species is \"", spec.species, "\"; expected gerbera, helianthus or bellis");
    const auto* stage = std::ranges::find_if(
        CAPITULUM_STAGES, [&](const CapitulumStage& known) { return spec.stage == std::string(1, known.name); });
    if (stage == std::end(CAPITULUM_STAGES)) fail("stage is \"", spec.stage, "\"; expected a, b, c or d");
    return Capitulum(spec, *species, *stage).make();
}

}  // namespace shvr
