#pragma once
// The processes that mpirun started. One thread, the post office, makes all calls of MPI, so that mail moves while the
// other threads draw, and MPI needs no support of threads.

#include <condition_variable>
#include <deque>
#include <future>
#include <list>
#include <mutex>
#include <thread>

#include "engine/ranks/ranks.h"

namespace shvr {

class MpiRanks final : public Ranks {
public:
    /// Waits until all processes have met.
    MpiRanks();
    ~MpiRanks() override;
    void end() override;

private:
    struct Outgoing;
    struct Incoming;

    void carry(int to, Box box, Mail mail) override;
    void run(std::promise<void>& met);
    bool send_waiting();
    bool receive();

    std::mutex mutex_;
    std::condition_variable changed_;
    struct Addressed {
        int to;
        Box box;
        Mail mail;
    };
    std::deque<Addressed> waiting_;  ///< mail that the post office has not seen yet
    bool is_ending_ = false;
    std::list<Outgoing> outgoing_;  ///< the post office's, like incoming_
    std::list<Incoming> incoming_;
    std::thread office_;
};

}  // namespace shvr
