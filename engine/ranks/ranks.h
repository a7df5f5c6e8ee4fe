#pragma once
// The processes that draw one picture together, called ranks, and the mail between them. Rank 0 has a desk, which hands
// out the work; every rank, rank 0 included, has a worker.
//
// The build decides which processes there are: engine/ranks/alone knows this one only, engine/ranks/mpi (built with
// -DSHVR_MPI=ON) knows those that mpirun started. Any thread.

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace shvr {

class Ranks {
public:
    enum class Box : uint8_t { desk, worker };
    struct Mail {
        int from = 0;
        std::string text;
        std::vector<float> values{};
    };

    virtual ~Ranks() = default;
    Ranks(const Ranks&) = delete;
    Ranks& operator=(const Ranks&) = delete;

    int index() const { return index_; }
    int count() const { return count_; }
    /// Returns at once. Mail from one rank to one box arrives in the order in which it was sent.
    void send(int to, Box box, std::string text, std::vector<float> values = {});
    /// Returns the oldest mail in a box of this rank; null if none arrives in time.
    std::optional<Mail> take(Box box, std::chrono::milliseconds longest);
    /// Waits until everything that was sent has arrived. Call it last, on every rank.
    virtual void end() {}

protected:
    Ranks(int index, int count) : index_(index), count_(count) {}
    /// Puts mail that has arrived into a box of this rank.
    void deliver(Box box, Mail mail);
    void set_place(int index, int count);

private:
    /// Sends mail to another rank. Returns at once.
    virtual void carry(int to, Box box, Mail mail) = 0;

    struct Inbox {
        std::mutex mutex;
        std::condition_variable arrived;
        std::deque<Mail> mails;
    };
    int index_, count_;
    std::array<Inbox, 2> boxes_;
};

/// This process alone.
class OneRank final : public Ranks {
public:
    OneRank() : Ranks(0, 1) {}

private:
    void carry(int to, Box box, Mail mail) override;
};

// ---- Defined by engine/ranks/alone or engine/ranks/mpi, as the build decides ----------------------------------------

/// Meets the other processes; without others, returns OneRank. Call it once.
std::unique_ptr<Ranks> open_ranks();
/// Index of this process among those that were started together, before any call of open_ranks; 0 without others.
int launched_rank();
/// A sentence for the user if processes were started together by mpirun, but this build cannot share work among them.
std::optional<std::string> why_not_shared();

}  // namespace shvr
