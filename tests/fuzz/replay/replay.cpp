// Runs one target on each of its seeds, on each seed cut short, and on a fixed number of changed seeds, under
// AddressSanitizer and UndefinedBehaviorSanitizer:  shvr_fuzz_replay TARGET [FILE...]
//
// FILE...: only these, unchanged. A seed named "claims_..." claims to be far larger than it is: it must be refused
// before more than MAX_BYTES_OF_A_CLAIM are allocated. --prove KIND proves that the replay finds such faults.

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/fuzz/replay/mutations.h"
#include "tests/fuzz/replay/targets.h"
#include "tests/fuzz/replay/watch.h"
#include "tests/fuzz/support/attempt.h"
#include "tests/support/slow.h"

namespace shvr::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr size_t MAX_NESTED = 48;
constexpr int64_t MAX_BYTES_OF_A_CLAIM = int64_t{8} << 20;

struct Seed {
    std::string name, bytes;
};

struct Totals {
    size_t inputs = 0, accepted = 0;
    Watched most{};
    std::string most_of{};
};

std::vector<Seed> seeds_in(const std::vector<fs::path>& files)
{
    std::vector<Seed> seeds;
    for (const fs::path& file : files) {
        std::ifstream stream(file, std::ios::binary);
        seeds.push_back({file.filename().string(), {std::istreambuf_iterator<char>(stream), {}}});
    }
    return seeds;
}

std::vector<fs::path> files_of(const fs::path& folder)
{
    std::vector<fs::path> files;
    if (fs::is_directory(folder)) {
        for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
    return files;
}

Watched run(const Target& target, const std::string& name, const std::string& input, Totals& totals)
{
    // On the heap without spare bytes, so that reads past the end are detected.
    const std::vector<uint8_t> bytes(input.begin(), input.end());
    last_outcome() = {};
    begin_watch(target.name, name, bytes, {});
    target.run(bytes.data(), bytes.size());
    const Watched watched = end_watch();
    ++totals.inputs;
    totals.accepted += last_outcome().was_accepted ? 1 : 0;
    if (watched.peak_bytes > totals.most.peak_bytes) totals.most_of = name;
    totals.most.peak_bytes = std::max(totals.most.peak_bytes, watched.peak_bytes);
    totals.most.seconds = std::max(totals.most.seconds, watched.seconds);
    return watched;
}

bool replay(const Target& target, const std::vector<Seed>& seeds)
{
    Totals totals;
    size_t accepted_seeds = 0;
    bool claims_hold = true;
    size_t claims = 0;
    Watched most_of_claims;
    const size_t max_cuts = test::repeats(1000, 4000);  // of all seeds together
    const size_t changed_inputs = test::repeats(1000, 3000);
    for (const Seed& seed : seeds) {
        const Watched watched = run(target, seed.name, seed.bytes, totals);
        accepted_seeds += last_outcome().was_accepted ? 1 : 0;
        if (!seed.name.starts_with("claims_")) continue;
        const bool holds = !last_outcome().was_accepted && watched.peak_bytes <= MAX_BYTES_OF_A_CLAIM;
        if (!holds) {
            std::fprintf(stderr, "%s: %s: %s with %lld bytes in %.3f s; expected a refusal with at most %lld bytes\n",
                         target.name, seed.name.c_str(), last_outcome().was_accepted ? "accepted" : "refused",
                         static_cast<long long>(watched.peak_bytes), watched.seconds,
                         static_cast<long long>(MAX_BYTES_OF_A_CLAIM));
        }
        claims_hold = claims_hold && holds;
        ++claims;
        most_of_claims.peak_bytes = std::max(most_of_claims.peak_bytes, watched.peak_bytes);
        most_of_claims.seconds = std::max(most_of_claims.seconds, watched.seconds);
    }
    for (const Seed& seed : seeds) {
        for (const size_t cut : cuts_of(seed.bytes.size(), max_cuts / seeds.size())) {
            run(target, seed.name + " cut to " + std::to_string(cut), seed.bytes.substr(0, cut), totals);
        }
    }
    size_t nested_inputs = 0;
    for (const Seed& seed : seeds) {
        if (nested_inputs > MAX_NESTED) break;
        for (const std::string& input : nested(seed.bytes)) {
            run(target, seed.name + " nested " + std::to_string(nested_inputs++), input, totals);
        }
    }
    for (size_t i = 0; i < changed_inputs; ++i) {
        const Seed& seed = seeds[i % seeds.size()];
        const Seed& other = seeds[(i * 7 + 3) % seeds.size()];
        run(target, seed.name + " change " + std::to_string(i), mutated(seed.bytes, other.bytes, i), totals);
    }
    std::printf("%s: %zu seeds, %zu inputs, %zu of them accepted; at most %.1f MiB (%s) and %.3f s each\n", target.name,
                seeds.size(), totals.inputs, totals.accepted, double(totals.most.peak_bytes) / (1 << 20),
                totals.most_of.c_str(), totals.most.seconds);
    if (claims > 0) {
        std::printf("%s: %zu seeds claim too much; each is refused within %.3f s, with at most %.1f KiB\n", target.name,
                    claims, most_of_claims.seconds, double(most_of_claims.peak_bytes) / 1024);
    }
    if (accepted_seeds == 0) std::fprintf(stderr, "%s: accepts none of its seeds; expected some\n", target.name);
    return accepted_seeds > 0 && claims_hold;
}

/// Commits a fault on purpose that sanitizers and limits must catch.
int prove(const std::string& kind)
{
    static const std::string what = kind;
    const Target target{"prove", [](const uint8_t* data, size_t size) {
                            if (what == "address") return data[size] == 1 ? 1 : 0;
                            volatile int largest = INT32_MAX;
                            if (what == "undefined") return largest + int(size);
                            if (what == "memory") return std::vector<char>(size_t{300} << 20).back() == 1 ? 1 : 0;
                            if (what == "exception") throw std::string("not an Error");
                            for (volatile uint64_t i = 0; what == "time";) i = i + 1;
                            return 0;
                        }};
    Totals totals;
    run(target, kind, "four", totals);
    return 0;
}

int main(const std::vector<std::string>& arguments)
{
    if (arguments.size() == 2 && arguments[0] == "--prove") return prove(arguments[1]);
    const auto target = std::find_if(targets().begin(), targets().end(), [&](const Target& candidate) {
        return !arguments.empty() && arguments[0] == candidate.name;
    });
    if (target == targets().end()) {
        std::fprintf(stderr, "usage: shvr_fuzz_replay TARGET [FILE...]; targets:");
        for (const Target& known : targets()) std::fprintf(stderr, " %s", known.name);
        std::fprintf(stderr, "\n");
        return 2;
    }
    if (arguments.size() > 1) {
        Totals totals;
        for (const Seed& seed : seeds_in({arguments.begin() + 1, arguments.end()})) {
            run(*target, seed.name, seed.bytes, totals);
            std::printf("%s: %s\n", seed.name.c_str(),
                        last_outcome().was_accepted ? "accepted" : last_outcome().refusal.c_str());
        }
        return 0;
    }
    const fs::path folder = fs::path("tests/fuzz/seeds") / target->name;
    const std::vector<Seed> seeds = seeds_in(files_of(folder));
    if (seeds.empty()) {
        std::fprintf(stderr, "%s: holds no seeds; expected some for target %s\n", folder.c_str(), target->name);
        return 1;
    }
    return replay(*target, seeds) ? 0 : 1;
}

}  // namespace
}  // namespace shvr::fuzz

int main(int count, char** arguments)
{
    return shvr::fuzz::main({arguments + 1, arguments + count});
}
