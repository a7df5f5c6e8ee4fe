#pragma once
// What interrupted work leaves on the disk, in words, so that a signal that ends the program can name it. Any thread.

#include <string>

namespace shvr {

/// Lists a part of a sentence during its lifetime: "scan.part keeps what the import has done". It is not listed if all
/// slots are taken, or if it is too long.
class UnfinishedWork {
public:
    explicit UnfinishedWork(const std::string& text);
    ~UnfinishedWork();
    UnfinishedWork(const UnfinishedWork&) = delete;
    UnfinishedWork& operator=(const UnfinishedWork&) = delete;

private:
    int slot_ = -1;  ///< below 0: not listed
};

/// Calls `say` with the text of each unfinished work. For signal handlers: calls only async-signal-safe functions.
void name_unfinished_work(void (*say)(const char* text));

}  // namespace shvr
