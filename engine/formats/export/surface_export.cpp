#include "engine/formats/export/surface_export.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/base/error.h"
#include "engine/base/image.h"
#include "engine/base/text.h"
#include "engine/formats/export/surface_forms.h"

namespace shvr {

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr const char* FEWER_GROUPS = "free some of it, or write fewer groups";

uint64_t total(const SurfaceParts& surfaces, uint64_t SurfacePart::*count)
{
    uint64_t sum = 0;
    for (const SurfacePart& part : surfaces.parts) sum += part.*count;
    return sum;
}

void expect_indices(const std::filesystem::path& path, uint64_t vertices)
{
    if (vertices > UINT32_MAX)
        fail(path.string(), ": would hold ", vertices, " vertices; expected at most 4294967295: write fewer groups");
}

uint8_t srgb_byte(double linear)
{
    return uint8_t(std::lround(255.0 * srgb_encode(std::clamp(linear, 0.0, 1.0))));
}

}  // namespace

SurfaceWriter::SurfaceWriter(const std::filesystem::path& path, uint64_t bytes)
    : writer_((expect_space(path, int64_t(bytes), FEWER_GROUPS), path))
{}

void SurfaceWriter::flush(size_t above)
{
    if (bytes_.size() < above) return;
    writer_.append(std::as_bytes(std::span(bytes_)));
    bytes_.clear();
}

void SurfaceWriter::commit()
{
    flush(0);
    writer_.commit();
}

const std::vector<std::string>& surface_extensions()
{
    static const std::vector<std::string> ALL{".stl", ".ply", ".obj", ".glb"};
    return ALL;
}

bool holds_one_surface(const std::filesystem::path& path)
{
    return lower_case(path.extension().string()) == ".stl";
}

void export_surfaces(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress)
{
    const std::string form = lower_case(path.extension().string());
    if (form == ".stl") return export_stl(path, surfaces, progress);
    if (form == ".ply") return export_ply(path, surfaces, progress);
    if (form == ".obj") return export_obj(path, surfaces, progress);
    if (form == ".glb") return export_glb(path, surfaces, progress);
    fail(path.string(), ": has the extension ", in_quotes(form), "; expected .stl, .ply, .obj or .glb");
}

void export_stl(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress)
{
    constexpr size_t HEADER = 80, TRIANGLE = 50;
    SHVR_CHECK(surfaces.parts.size() == 1, surfaces.parts.size());
    const SurfacePart& part = surfaces.parts[0];
    if (part.triangles > UINT32_MAX)
        fail(path.string(), ": would hold ", part.triangles, " triangles; expected at most 4294967295: use .ply");
    SurfaceWriter writer(path, HEADER + 4 + TRIANGLE * part.triangles);
    // A header that began with "solid" would mark a text file. Only the facts that change how the file is read fit into
    // it; of these, a long unit may be cut.
    std::string header = sentence("SHVR surface, group ", part.group);
    for (const char* const fact : {"SPACE=", "space ", "unit "})
        for (const std::string& comment : surfaces.comments)
            if (comment.starts_with(fact)) header += ", " + printable(comment);
    header.resize(HEADER, ' ');
    writer.text(header);
    writer.values(uint32_t(part.triangles));
    surfaces.for_each_triangle(
        part,
        [&](const glm::uvec3&, const std::array<glm::dvec3, 3>& at) {
            const glm::dvec3 across = glm::cross(at[1] - at[0], at[2] - at[0]);
            const double length = glm::length(across);
            const glm::vec3 normal(length > 0.0 ? across / length : glm::dvec3(0.0));
            writer.values(normal, glm::vec3(at[0]), glm::vec3(at[1]), glm::vec3(at[2]), uint16_t{0});
        },
        progress);
    writer.commit();
}

void export_ply(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress)
{
    const uint64_t vertices = total(surfaces, &SurfacePart::vertices),
                   triangles = total(surfaces, &SurfacePart::triangles);
    expect_indices(path, vertices);
    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& comment : surfaces.comments) header += "comment " + printable(comment) + "\n";
    for (const SurfacePart& part : surfaces.parts)
        header += sentence("comment group ", part.group, " is ", printable(part.name), "\n");
    header += sentence("element vertex ", vertices, "\nproperty double x\nproperty double y\nproperty double z\n",
                       "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face ", triangles,
                       "\nproperty list uchar uint vertex_indices\nproperty uchar group\nend_header\n");
    SurfaceWriter writer(path, header.size() + 27 * vertices + 14 * triangles);
    writer.text(header);
    PartProgress steps(progress, 2 * surfaces.parts.size());
    for (const SurfacePart& part : surfaces.parts) {
        const uint8_t red = srgb_byte(part.color.r), green = srgb_byte(part.color.g), blue = srgb_byte(part.color.b);
        surfaces.for_each_vertex(
            part, [&](const glm::dvec3& at) { writer.values(at, red, green, blue); }, steps.next());
    }
    uint32_t first = 0;
    for (const SurfacePart& part : surfaces.parts) {
        surfaces.for_each_triangle(
            part,
            [&](const glm::uvec3& indices, const auto&) {
                writer.values(uint8_t{3}, first + indices, uint8_t(part.group));
            },
            steps.next());
        first += uint32_t(part.vertices);
    }
    writer.commit();
}

void export_obj(const std::filesystem::path& path, SurfaceParts& surfaces, const Progress& progress)
{
    constexpr uint64_t MAX_DIGITS = 24;  // of a number with its space
    const uint64_t vertices = total(surfaces, &SurfacePart::vertices),
                   triangles = total(surfaces, &SurfacePart::triangles);
    const uint64_t digits = std::to_string(vertices).size() + 1;
    SurfaceWriter writer(path, vertices * (2 + 3 * MAX_DIGITS) + triangles * (2 + 3 * digits));
    for (const std::string& comment : surfaces.comments) writer.text("# " + printable(comment) + "\n");
    PartProgress steps(progress, 2 * surfaces.parts.size());
    uint64_t first = 1;  // vertices count from 1
    for (const SurfacePart& part : surfaces.parts) {
        writer.text(sentence("# group ", part.group, " is ", printable(part.name), "\ng group_", part.group, "\n"));
        surfaces.for_each_vertex(
            part, [&](const glm::dvec3& at) { writer.text("v " + digits_of(at) + "\n"); }, steps.next());
        surfaces.for_each_triangle(
            part,
            [&](const glm::uvec3& indices, const auto&) {
                std::string line = "f";
                for (int i = 0; i < 3; ++i) line += ' ' + std::to_string(first + indices[i]);
                writer.text(line + "\n");
            },
            steps.next());
        first += part.vertices;
    }
    writer.commit();
}

}  // namespace shvr
