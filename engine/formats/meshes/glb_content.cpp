#include "engine/formats/meshes/glb_content.h"

#include <algorithm>

#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/formats/meshes/glb_tables.h"

namespace shvr {
namespace {

constexpr size_t MAX_PRIMITIVES = size_t{1} << 16;
constexpr int64_t MAX_MODE = 6;

/// The primitives of all nodes of the scene, collected from the roots on.
class GlbScene {
public:
    GlbScene(const JsonDocument& json, const GlbBinary& binary, MeshMemory& memory)
        : memory_(memory),
          root_(json.root()),
          nodes_(root_, "nodes"),
          meshes_(root_, "meshes"),
          materials_(root_, "materials"),
          accessors_(root_, binary)
    {}

    std::vector<GlbPrimitive> collect()
    {
        struct Visit {
            size_t node;
            glm::dmat4 placed;
        };
        std::vector<bool> is_visited(nodes_.size(), false);
        std::vector<Visit> open;
        const std::vector<size_t> roots = roots_of_scene();
        for (auto root = roots.rbegin(); root != roots.rend(); ++root) open.push_back({*root, glm::dmat4(1.0)});
        while (!open.empty()) {
            const Visit visit = open.back();
            open.pop_back();
            const JsonNode& node = nodes_[visit.node];
            if (is_visited[visit.node]) node.refuse_because("is reached twice; expected nodes that form a tree");
            is_visited[visit.node] = true;
            const glm::dmat4 placed = visit.placed * transform_of(node);
            if (node["mesh"].exists()) add_mesh(visit.node, placed);
            const std::vector<JsonNode> children = children_of(node);
            for (auto child = children.rbegin(); child != children.rend(); ++child)
                open.push_back({nodes_.number_in(*child), placed});
        }
        return std::move(found_);
    }

private:
    static std::vector<JsonNode> children_of(const JsonNode& node)
    {
        return node["children"].exists() ? node["children"].elements() : std::vector<JsonNode>{};
    }

    std::vector<size_t> roots_of_scene() const
    {
        std::vector<size_t> roots;
        const GlbTable scenes(root_, "scenes");
        if (scenes.size() > 0) {
            const JsonNode& scene = root_["scene"].exists() ? scenes.at(root_["scene"]) : scenes[0];
            if (!scene["nodes"].exists()) return roots;
            for (const JsonNode& node : scene["nodes"].elements()) roots.push_back(nodes_.number_in(node));
            return roots;
        }
        std::vector<bool> is_child(nodes_.size(), false);
        for (size_t i = 0; i < nodes_.size(); ++i)
            for (const JsonNode& child : children_of(nodes_[i])) is_child[nodes_.number_in(child)] = true;
        for (size_t i = 0; i < nodes_.size(); ++i)
            if (!is_child[i]) roots.push_back(i);
        return roots;
    }

    void add_mesh(size_t number, const glm::dmat4& placed)
    {
        const JsonNode& node = nodes_[number];
        if (node["skin"].exists()) node["skin"].refuse("a mesh without a skeleton: export it in its pose");
        if (const JsonNode copies = node["extensions"]["EXT_mesh_gpu_instancing"]; copies.exists())
            copies.refuse_because("states copies of a mesh; expected none: export each as a node of its own");
        const JsonNode& mesh = meshes_.at(node["mesh"]);
        const JsonNode name = mesh["name"].is_text() ? mesh["name"] : node["name"];
        for (const JsonNode& primitive : mesh.required("primitives", "an array").elements()) {
            const int64_t mode = primitive["mode"].whole(int64_t(GlbMode::triangles), 0, MAX_MODE);
            if (mode < int64_t(GlbMode::triangles)) continue;  // points and lines
            GlbPrimitive found{.node = number, .placed = placed, .mode = GlbMode(mode)};
            const JsonNode attributes = primitive.required("attributes", "an object");
            found.positions = accessors_.positions(attributes.required("POSITION", "the number of an accessor"));
            if (primitive["indices"].exists()) found.indices = accessors_.indices(primitive["indices"]);
            if (found.corners() < 3 || (found.mode == GlbMode::triangles && found.corners() % 3 != 0))
                primitive.refuse_because(sentence("has ", found.corners(), " corners; expected ",
                                                  found.corners() < 3 ? "at least 3" : "three for each triangle"));
            if (name.is_text()) found.name = name.any_text();
            if (primitive["material"].exists()) found.color = color_of(materials_.at(primitive["material"]));
            if (found_.size() == MAX_PRIMITIVES)
                mesh.refuse_because(sentence("exceeds the number of primitives in a scene; expected at most ",
                                             MAX_PRIMITIVES, " in all: join some of them"));
            memory_.append(found_, found);
        }
    }

    static std::optional<glm::vec3> color_of(const JsonNode& material)
    {
        const JsonNode factor = material["pbrMetallicRoughness"]["baseColorFactor"];
        if (!factor.exists()) return std::nullopt;
        glm::vec3 color;
        const std::vector<JsonNode> channels = factor.elements(4, 4);
        for (int i = 0; i < 3; ++i) color[i] = float(srgb_encode(channels[size_t(i)].number({0.0, 1.0})));
        return color;
    }

    MeshMemory& memory_;
    JsonNode root_;
    GlbTable nodes_, meshes_, materials_;
    GlbAccessors accessors_;
    std::vector<GlbPrimitive> found_{};
};

void check_version(const JsonNode& root)
{
    const JsonNode version = root.required("asset", "an object")["version"];
    if (!version.is_text() || !version.any_text().starts_with("2.")) version.refuse("\"2.0\"");
    const JsonNode needed = root["extensionsRequired"];
    if (!needed.exists()) return;
    for (const JsonNode& extension : needed.elements())  // those of materials do not change shapes
        if (!extension.is_text() || !extension.any_text().starts_with("KHR_materials_"))
            extension.refuse("none: export it without extensions such as compression");
}

}  // namespace

std::vector<GlbPrimitive> primitives_of(const JsonDocument& json, const GlbBinary& binary, MeshMemory& memory)
{
    check_version(json.root());
    return GlbScene(json, binary, memory).collect();
}

MeshStatements statements_of(const JsonDocument& json)
{
    MeshStatements statements;
    const JsonNode comments = json.root()["asset"]["extras"]["comments"];
    if (comments.is_array())
        for (const JsonNode& comment : comments.elements())
            if (comment.is_text()) statements.take(comment.any_text());
    return statements;
}

}  // namespace shvr
