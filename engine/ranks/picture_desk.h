#pragma once
// The desk of rank 0: hands out the rows of a picture to the workers that ask, and passes the rows that arrive on, in
// order, from a thread of its own. Rows that arrive early wait; rows too far ahead are not handed out, so that the
// waiting ones have room.

#include <atomic>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "engine/base/image.h"
#include "engine/ranks/ranks.h"
#include "engine/ranks/row_plan.h"

namespace shvr {

/// What holds for the whole picture.
struct DeskPicture {
    int64_t width = 0, height = 0;
    int64_t window_rows = 0;  ///< how far a strip may reach beyond the rows taken; the next rows are always drawn
};

class PictureDesk {
public:
    /// Receives the next rows from the top, as wide as the picture, on the desk's thread.
    using TakeRows = std::function<void(ImageF rows)>;
    PictureDesk(Ranks& ranks, RowPlan plan, const DeskPicture& picture, TakeRows take_rows);
    /// Ends the work of all ranks, and waits for them.
    ~PictureDesk();
    PictureDesk(const PictureDesk&) = delete;
    PictureDesk& operator=(const PictureDesk&) = delete;

    /// Waits until all workers have ended, and returns their reports, by rank. Fails as the first rank that failed has
    /// failed, or as `take_rows` has. Call it after this rank's own worker has ended.
    std::vector<std::string> finish();
    /// Whether a rank has failed, so that no more rows are drawn.
    bool has_failed() const { return is_ending_; }
    double progress() const { return double(written_rows_) / double(picture_.height); }
    int64_t peak_waiting_rows() const { return peak_waiting_rows_; }

private:
    void run();
    void handle(Ranks::Mail mail);
    void take_rows(int64_t lower, ImageF rows);
    void hand_out();
    void end_worker(int rank);
    void end_all();
    void note_failure(std::exception_ptr failure);

    Ranks& ranks_;
    RowPlan plan_;
    DeskPicture picture_;
    TakeRows take_rows_;
    std::vector<int> asking_;             ///< ranks that wait for rows
    std::vector<bool> is_ending_worker_;  ///< by rank
    std::vector<std::string> reports_;    ///< by rank
    std::map<int64_t, ImageF> waiting_;   ///< rows that arrived early, by their first
    int64_t waiting_rows_ = 0;
    std::exception_ptr failure_;  ///< the first one
    int ended_ = 0;               ///< workers that have ended
    std::atomic<bool> is_ending_ = false;
    std::atomic<int64_t> written_rows_ = 0, peak_waiting_rows_ = 0;
    std::thread thread_;
};

/// On rank 0, if it fails before it has a desk: ends the work of all other ranks, and waits for them.
void end_other_ranks(Ranks& ranks);

}  // namespace shvr
