#include "tools/bench/peer.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include <nlohmann/json.hpp>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/base/text.h"
#include "tools/golden/light.h"

namespace shvr::bench {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* FAMILY = "VTK";
constexpr const char* CAMERA = "bench";
constexpr int64_t PADDING = 2;  // padding by 2 voxels: VTK's volume ends at the centres of its outermost voxels, and so
                                // do its gradients
constexpr int PATIENCE_S = 300;
constexpr int64_t MAX_COMPLAINT_BYTES = 1 << 20;

Json numbers(const glm::dvec3& vector)
{
    return {vector.x, vector.y, vector.z};
}

const char* nrrd_type(VoxelType type)
{
    switch (type) {
        case VoxelType::uint8: return "uint8";
        case VoxelType::int8: return "int8";
        case VoxelType::uint16: return "uint16";
        case VoxelType::int16: return "int16";
        case VoxelType::float32: return "float";
        default: return nullptr;
    }
}

/// The volume with its border repeated.
void write_volume(const VolumeSource& source, const std::filesystem::path& folder)
{
    const VolumeInfo& info = source.info();
    const size_t bytes = bytes_of(info.type);
    const Size3 size = info.size, padded = size + 2 * PADDING;
    std::vector<std::byte> voxels(size_t(voxel_count(info)) * bytes), made;
    source.read({Size3(0), size}, voxels);
    made.reserve(size_t(padded.x * padded.y * padded.z) * bytes);
    for (int64_t z = -PADDING; z < size.z + PADDING; ++z)
        for (int64_t y = -PADDING; y < size.y + PADDING; ++y)
            for (int64_t x = -PADDING; x < size.x + PADDING; ++x) {
                const Size3 at = glm::clamp(Size3(x, y, z), Size3(0), size - int64_t{1});
                const std::byte* const voxel = &voxels[size_t(at.x + size.x * (at.y + size.y * at.z)) * bytes];
                made.insert(made.end(), voxel, voxel + bytes);
            }
    const std::string header = sentence(
        "NRRD0005\ntype: ", nrrd_type(info.type), "\ndimension: 3\nsizes: ", padded.x, " ", padded.y, " ", padded.z,
        "\nspacings: ", digits_of(info.spacing.x), " ", digits_of(info.spacing.y), " ", digits_of(info.spacing.z),
        "\nencoding: raw\nendian: little\npadded:=", PADDING, "\ndata file: volume.raw\n");
    write_file_atomically(folder / "volume.raw", made);
    write_file_atomically(folder / "volume.nhdr", std::as_bytes(std::span(header)));
}

void write_session(const Session& session, const VolumeInfo& info, const Camera& camera,
                   const std::filesystem::path& folder)
{
    Json points = Json::array();
    for (const ControlPoint& point : session.transfer_function.points())
        points.push_back({{"intensity", point.intensity}, {"color", numbers(point.color)}, {"opacity", point.opacity}});
    const bool is_flat = camera.projection == Camera::Projection::orthographic;
    const Light& light = session.light;
    const Json json{{"volume", {{"path", "volume.nhdr"}}},
                    {"cameras",
                     {{CAMERA,
                       {{"projection", is_flat ? "orthographic" : "perspective"},
                        {"eye", numbers(camera.eye)},
                        {"target", numbers(camera.target)},
                        {"up", numbers(camera.up)},
                        {"fov_y_degrees", camera.fov_y_degrees},
                        {"height", camera.height}}}}},
                    {"transfer_function", {{"points", points}}},
                    {"light",
                     {{"shaded", light.shaded},
                      {"ambient", light.ambient},
                      {"diffuse", light.diffuse},
                      {"specular", light.specular},
                      {"shininess", light.shininess},
                      {"direction", numbers(light.direction)}}},
                    {"render",
                     {{"size", {session.render.size.x, session.render.size.y}},
                      {"background", numbers(glm::dvec3(session.render.background))}}},
                    {"cut",
                     {{"lower", numbers(glm::max(session.cut.lower, glm::dvec3(0.0)))},
                      {"upper", numbers(glm::min(session.cut.upper, glm::dvec3(info.size)))}}}};
    const std::string text = json.dump(1);
    write_file_atomically(folder / "session.json", std::as_bytes(std::span(text)));
}

}  // namespace

std::vector<PeerRun> peer_runs(const PeerOptions& options, bool quick)
{
    std::vector<PeerRun> runs;
    for (const std::string& mapper : options.mappers) {
        const std::string family = mapper == "gpu" ? "VTK OpenGL" : FAMILY;
        for (const double step : quick ? std::vector{2.0, 1.0, 0.5, 0.25} : std::vector{4.0, 2.0, 1.0, 0.5, 0.25})
            runs.push_back({sentence(family, " step ", digits_of(step)), family, mapper, step});
    }
    return runs;
}

bool is_peer(const std::string& family)
{
    return family.starts_with(FAMILY);
}

std::optional<std::string> why_not_by_peer(const Session& session, const VolumeSource& source, const Camera& camera,
                                           const std::string& mapper)
{
    const Light& light = session.light;
    if (!nrrd_type(source.info().type)) return sentence("it reads no voxels of ", name_of(source.info().type));
    if (!session.surfaces.empty()) return "the scene has surfaces, which it draws of triangles";
    if (!session.mask_path.empty()) return "the scene is painted";
    if (light.shaded && light.gradient_fade != 0.0)
        return "its shading does not fade where there is no surface (light.gradient_fade)";
    if (light.shaded && light.specular != 0.0) return "its highlights are of another kind (light.specular)";
    if (light.shaded && shows_occlusion(light)) return "it has no ambient occlusion";
    if (session.render.paging == Paging::always) return "it does not page";
    if (session.render.background.a != 1.0) return "its background is opaque";
    if (camera.near_distance != 0.0 || camera.far_distance != 0.0 || camera.shift_right != 0.0)
        return "the camera has clipping planes or an axis of its own";
    const std::span<const ControlPoint> points = session.transfer_function.points();
    const bool is_of_one_color =
        std::ranges::all_of(points, [&](const ControlPoint& point) { return point.color == points[0].color; });
    if (mapper == "gpu" && light.shaded && !is_of_one_color)
        return "its OpenGL mapper gives ambient light no colour of the volume's";
    return std::nullopt;
}

Peer::Peer(const PeerOptions& options, const Session& session, const VolumeSource& source, const Camera& camera)
{
    std::string pattern = (std::filesystem::temp_directory_path() / "shvr-peer-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) fail(pattern, ": no folder can be made; expected a place for the peer's scene");
    folder_ = pattern;
    write_volume(source, folder_);
    write_session(session, source.info(), camera, folder_);

    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
        fail("VTK cannot be talked to: ", std::strerror(errno), "; expected a pair of sockets");
    socket_ = ends[0];
    const timeval patience{PATIENCE_S, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    const std::string errors = (folder_ / "errors").string();
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), O_WRONLY | O_CREAT, 0600);
    std::vector<std::string> texts{
        options.program.string(), "--serve", (folder_ / "session.json").string(), "--camera", CAMERA, "--threads",
        sentence(options.threads)};
    std::vector<char*> arguments;
    for (std::string& text : texts) arguments.push_back(text.data());
    arguments.push_back(nullptr);
    const int error = ::posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    try {
        if (error != 0) {
            process_ = -1;
            fail(options.program.string(), " cannot be started: ", std::strerror(error));
        }
        version_ = Json::parse(next_line()).at("vtk").get<std::string>();
    } catch (...) {
        end();
        throw;
    }
}

Peer::~Peer()
{
    end();
}

void Peer::end()
{
    // Closing its input ends it.
    if (socket_ >= 0) ::shutdown(socket_, SHUT_RDWR), ::close(socket_);
    int status = 0;
    if (process_ > 0) ::waitpid(process_, &status, 0);
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::string Peer::next_line()
{
    for (;;) {
        const size_t end = received_.find('\n');
        if (end != std::string::npos) {
            const std::string line = received_.substr(0, end);
            received_.erase(0, end + 1);
            // Skips other output, such as that of xvfb-run.
            if (line.starts_with("{")) return line;
            continue;
        }
        char part[4096];
        const ssize_t count = ::recv(socket_, part, sizeof(part), 0);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) {
            const std::string errors = read_text(folder_ / "errors", MAX_COMPLAINT_BYTES);
            const std::string said(trimmed(errors));
            fail("the program with VTK ended: ", said.empty() ? "it said nothing" : said.substr(said.rfind('\n') + 1));
        }
        received_.append(part, size_t(count));
    }
}

double Peer::ask(const PeerRun& run, const std::filesystem::path& output)
{
    const Json request{
        {"mapper", run.mapper}, {"step", run.step}, {"output", output.empty() ? Json(nullptr) : Json(output.string())}};
    const std::string line = request.dump() + "\n";
    for (size_t sent = 0; sent < line.size();) {
        const ssize_t count = ::send(socket_, line.data() + sent, line.size() - sent, MSG_NOSIGNAL);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;  // the peer has ended; reading its answer reports the reason
        sent += size_t(count);
    }
    return Json::parse(next_line()).at("ms").get<double>();
}

double Peer::draw(const PeerRun& run)
{
    return ask(run, {});
}

ImageF Peer::picture(const PeerRun& run)
{
    const std::filesystem::path path = folder_ / "picture.pfm";
    ask(run, path);
    return golden::read_light(path);
}

}  // namespace shvr::bench
