#pragma once
// The comparison program: VTK's volume ray casters, which tools/peers/vtk_raycast.py runs on request. It is optional:
// if it cannot be started, the results contain a sentence that states why.
//
// One thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/base/image.h"
#include "engine/session/session.h"

namespace shvr::bench {

struct PeerOptions {
    std::filesystem::path program;  ///< vtk_raycast.py or a program with the same interface; empty: no comparison
    std::vector<std::string> mappers = {"fixed"};
    int threads = 2;
};

/// A run of the peer program.
struct PeerRun {
    std::string name, family;  ///< "VTK step 0.5", "VTK"
    std::string mapper;        ///< "fixed", "gpu"
    double step = 1.0;         ///< reference lengths
};
/// The runs of all mappers.
std::vector<PeerRun> peer_runs(const PeerOptions& options, bool quick);
/// Returns whether runs of this family were drawn by the comparison program.
bool is_peer(const std::string& family);

/// Returns the reason why VTK cannot draw the same picture, worded as the end of a sentence; null if VTK can.
std::optional<std::string> why_not_by_peer(const Session& session, const VolumeSource& source, const Camera& camera,
                                           const std::string& mapper);

class Peer {
public:
    /// Starts the peer on a scene. Fails with a sentence if the peer cannot be started or ends early.
    Peer(const PeerOptions& options, const Session& session, const VolumeSource& source, const Camera& camera);
    ~Peer();
    Peer(const Peer&) = delete;
    Peer& operator=(const Peer&) = delete;

    /// "9.1.0".
    const std::string& version() const { return version_; }
    /// Returns the time in milliseconds.
    double draw(const PeerRun& run);
    /// Returns the picture in linear light.
    ImageF picture(const PeerRun& run);

private:
    double ask(const PeerRun& run, const std::filesystem::path& output);
    std::string next_line();
    void end();

    std::filesystem::path folder_;
    int process_ = -1, socket_ = -1;
    std::string received_, version_;
};

}  // namespace shvr::bench
