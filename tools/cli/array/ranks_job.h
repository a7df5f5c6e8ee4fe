#pragma once
// shvr render under mpirun: this process as one of several that draw one picture (engine/ranks). Rank 0 alone prints.

#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "engine/ranks/ranks.h"

namespace shvr::cli {

/// Silences the command if it is one that ranks share, and this is another rank than 0: what it would print, rank 0
/// prints. Call before anything is printed.
void silence_other_ranks(int argc, char** argv);
/// Meets the other ranks; they stay until `leave_ranks`.
Ranks& join_ranks();
/// Notes that all workers have ended, so that rank 0 need not wait for them.
void note_ranks_have_ended();
/// Ends this rank. `failure`: why its command failed; empty: it has not. Rank 0 ends the others; another rank tells
/// rank 0, which prints. Returns whether this process decides the exit status, as a process without others does.
bool leave_ranks(const std::string& failure);

/// While it exists, a signal that asks to stop ends this rank at once, without half a file: mpirun sends one to all
/// ranks when one of them is lost, and kills them a second later. The others also remove what a killed rank 0 left.
class RanksWatch {
public:
    RanksWatch(const Ranks& ranks, std::filesystem::path output);

private:
    std::jthread thread_;
};

}  // namespace shvr::cli
