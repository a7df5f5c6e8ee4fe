#include "engine/formats/inflated_bytes.h"

#define ZLIB_CONST
#include <zlib.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "engine/base/error.h"

namespace shvr {
namespace {

constexpr int64_t MAX_EXPANSION = 1032;
constexpr int64_t CHUNK_BYTES = int64_t{1} << 20;
constexpr int64_t CHUNKS_BETWEEN_STATES = 4;
constexpr int64_t MAX_STATES = 512;

constexpr size_t INPUT_BYTES = 65536;

constexpr int ANY_WRAPPING = 15 + 32;
constexpr int GZIP_WRAPPING = 15 + 16;

/// A decoder at some position in the compressed bytes. A copy of a decoder continues from that position.
class Decoder {
public:
    Decoder(const InputFile& file, int64_t offset) : file_(file), input_at_(offset)
    {
        check_memory(::inflateInit2(&stream_, ANY_WRAPPING));
    }
    Decoder(const Decoder& other)
        : file_(other.file_),
          input_at_(other.input_at_ - int64_t{other.stream_.avail_in}),
          output_at_(other.output_at_),
          has_ended_(other.has_ended_)
    {
        check_memory(::inflateCopy(&stream_, const_cast<z_stream*>(&other.stream_)));
        stream_.next_in = nullptr;
        stream_.avail_in = 0;
    }
    Decoder& operator=(const Decoder&) = delete;
    ~Decoder() { ::inflateEnd(&stream_); }

    int64_t output_at() const { return output_at_; }

    /// Decodes the next bytes; returns their number, which is smaller than requested only at the end of the stream.
    size_t decode(std::span<std::byte> bytes)
    {
        size_t done = 0;
        while (done < bytes.size() && !has_ended_) {
            const size_t count = decode_some(bytes.subspan(done));
            done += count;
            output_at_ += int64_t(count);
        }
        return done;
    }

    /// Called after the last byte: lets zlib read the checksum that follows, and fails if it does not match.
    void finish()
    {
        std::byte left_over{};
        while (!has_ended_ && decode_some({&left_over, 1}) == 0) {
        }
    }

private:
    void check_memory(int result) const
    {
        if (result != Z_OK) fail(file_.path.string(), ": cannot be decompressed: no memory for zlib");
    }

    size_t decode_some(std::span<std::byte> bytes)
    {
        if (stream_.avail_in == 0) refill();
        constexpr size_t MOST = size_t{1} << 30;  // zlib counts in 32 bits
        const size_t room = std::min(bytes.size(), MOST);
        stream_.next_out = reinterpret_cast<Bytef*>(bytes.data());
        stream_.avail_out = static_cast<uInt>(room);
        const int result = ::inflate(&stream_, Z_NO_FLUSH);
        const size_t count = room - stream_.avail_out;
        if (result == Z_STREAM_END) {
            begin_next_member();
        } else if (result == Z_MEM_ERROR) {
            check_memory(result);
        } else if (result != Z_OK && result != Z_BUF_ERROR) {
            fail(file_.path.string(), ": is damaged after ", output_at_ + int64_t(count),
                 " decompressed bytes: ", stream_.msg == nullptr ? "a dictionary is asked for" : stream_.msg,
                 "; expected deflated data");
        }
        return count;
    }

    void refill()
    {
        input_.resize(INPUT_BYTES);
        const size_t count = file_.read_some(input_at_, std::as_writable_bytes(std::span(input_)));
        if (count == 0) {
            fail(file_.path.string(), ": is truncated: its compressed data ends after ", output_at_,
                 " decompressed bytes, in the middle; expected its end");
        }
        input_at_ += int64_t(count);
        stream_.next_in = input_.data();
        stream_.avail_in = static_cast<uInt>(count);
    }

    /// Continues with the next member, since gzip files may be concatenated. Like gzip, ignores other trailing bytes.
    void begin_next_member()
    {
        std::array<std::byte, 2> next{};
        const int64_t at = input_at_ - int64_t{stream_.avail_in};
        const bool is_gzip = file_.read_some(at, next) == 2 && next[0] == std::byte{0x1f} && next[1] == std::byte{0x8b};
        has_ended_ = !is_gzip || ::inflateReset2(&stream_, GZIP_WRAPPING) != Z_OK;
    }

    const InputFile& file_;
    z_stream stream_{};
    int64_t input_at_ = 0;  ///< position of the byte after `input_`
    int64_t output_at_ = 0;
    bool has_ended_ = false;
    std::vector<Bytef> input_;  ///< empty in saved states
};

class InflatedBytes final : public VoxelBytes {
public:
    explicit InflatedBytes(Inflation inflation)
        : inflation_(std::move(inflation)),
          end_(inflation_.skip_bytes + inflation_.wanted_bytes),
          chunk_bytes_(std::min(CHUNK_BYTES, end_)),
          chunks_between_states_(std::max(CHUNKS_BETWEEN_STATES, (chunk_of(end_) + MAX_STATES) / MAX_STATES)),
          max_kept_(size_t(std::max<int64_t>(2, inflation_.kept_bytes / chunk_bytes_)))
    {}

    void read(int64_t offset, std::span<std::byte> bytes) const override
    {
        offset += inflation_.skip_bytes;
        SHVR_CHECK(offset >= 0 && offset + int64_t(bytes.size()) <= end_, offset, " ", bytes.size());
        while (!bytes.empty()) {
            const std::shared_ptr<const Bytes> chunk = decoded(chunk_of(offset));
            const std::span<const std::byte> rest = std::span(*chunk).subspan(size_t(offset % chunk_bytes_));
            const size_t count = std::min(rest.size(), bytes.size());
            std::copy_n(rest.begin(), count, bytes.begin());
            bytes = bytes.subspan(count);
            offset += int64_t(count);
        }
    }

private:
    using Bytes = std::vector<std::byte>;
    struct Chunk {
        int64_t number = 0;
        std::shared_ptr<const Bytes> bytes{};
    };

    int64_t chunk_of(int64_t offset) const { return offset / chunk_bytes_; }

    std::shared_ptr<const Bytes> decoded(int64_t number) const
    {
        const std::lock_guard lock(mutex_);
        const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Chunk& c) { return c.number == number; });
        if (found != kept_.end()) {
            std::rotate(kept_.begin(), found, found + 1);  // most recently used first
            return kept_.front().bytes;
        }
        go_before(number);
        try {
            while (chunk_of(decoder_->output_at()) < number) decode_next();
            return decode_next();
        } catch (...) {
            decoder_.reset();  // unusable: it stopped in the middle of a chunk
            throw;
        }
    }

    /// Moves the decoder to the start of chunk `number`, or as close before it as the decoder or a saved state allows.
    void go_before(int64_t number) const
    {
        const int64_t state = std::min(number / chunks_between_states_, int64_t(states_.size()) - 1);
        const bool is_near = decoder_ && chunk_of(decoder_->output_at()) <= number &&
                             chunk_of(decoder_->output_at()) >= state * chunks_between_states_;
        if (is_near) return;
        decoder_ = state < 0 ? std::make_unique<Decoder>(inflation_.file, inflation_.offset_bytes)
                             : std::make_unique<Decoder>(*states_[size_t(state)]);
    }

    std::shared_ptr<const Bytes> decode_next() const
    {
        const int64_t begin = decoder_->output_at();
        const int64_t number = chunk_of(begin);
        if (number == chunks_between_states_ * int64_t(states_.size())) {
            states_.push_back(std::make_unique<const Decoder>(*decoder_));
        }
        const auto chunk = std::make_shared<Bytes>(size_t(std::min(chunk_bytes_, end_ - begin)));
        if (decoder_->decode(*chunk) < chunk->size()) {
            fail(inflation_.file.path.string(), ": holds ", decoder_->output_at(), " decompressed bytes; expected ",
                 end_, " for the voxels that its header states");
        }
        if (decoder_->output_at() == end_) {
            decoder_->finish();
            decoder_.reset();
        }
        if (kept_.size() == max_kept_) kept_.pop_back();
        kept_.insert(kept_.begin(), {number, chunk});
        return chunk;
    }

    Inflation inflation_;
    int64_t end_;  ///< in decoded bytes, like all offsets here
    int64_t chunk_bytes_;
    int64_t chunks_between_states_;
    size_t max_kept_;

    mutable std::mutex mutex_;
    mutable std::unique_ptr<Decoder> decoder_;  ///< at the start of a chunk; null: no position yet
    mutable std::vector<std::unique_ptr<const Decoder>> states_;
    mutable std::vector<Chunk> kept_;
};

}  // namespace

bool begins_as_gzip(std::string_view head)
{
    return head.starts_with("\x1f\x8b");
}

std::unique_ptr<VoxelBytes> bytes_of_deflated(Inflation inflation)
{
    const std::string name = inflation.file.path.string();
    SHVR_CHECK(inflation.offset_bytes >= 0 && inflation.skip_bytes >= 0 && inflation.wanted_bytes > 0);
    std::array<std::byte, 2> start{};
    const bool has_start = inflation.file.read_some(inflation.offset_bytes, start) == 2;
    const unsigned first = std::to_integer<unsigned>(start[0]);
    const unsigned both = first << 8 | std::to_integer<unsigned>(start[1]);
    const bool is_zlib = (first & 15) == 8 && both % 31 == 0;  // RFC 1950, 2.2
    if (!has_start || (both != 0x1f8b && !is_zlib)) {
        fail(name, ": its compressed data at byte ", inflation.offset_bytes,
             has_start ? " begins as neither gzip nor zlib does" : " is missing", "; expected one of them");
    }
    int64_t needed = 0;
    int64_t most = 0;
    const int64_t compressed = inflation.file.bytes - inflation.offset_bytes;
    if (__builtin_add_overflow(inflation.skip_bytes, inflation.wanted_bytes, &needed)) needed = -1;
    if (__builtin_mul_overflow(compressed, MAX_EXPANSION, &most)) most = -1;
    if (needed < 0 || (most >= 0 && most < needed)) {
        fail(name, ": holds ", compressed, " compressed bytes, which cannot become more than ", most,
             "; expected enough for the ", inflation.wanted_bytes, " bytes of voxels that its header states");
    }
    return std::make_unique<InflatedBytes>(std::move(inflation));
}

std::string inflated_head(const std::filesystem::path& path, size_t max_bytes)
{
    const InputFile file = open_input_file(path);
    std::string head(max_bytes, '\0');
    const auto bytes = std::as_writable_bytes(std::span(head));
    Decoder decoder(file, 0);
    size_t done = 0;
    try {
        // Decodes one byte at a time, so that all bytes before a damaged one are returned.
        while (done < max_bytes && decoder.decode(bytes.subspan(done, 1)) == 1) ++done;
    } catch (const Error&) {
        // The file's reader will report the problem.
    }
    head.resize(done);
    return head;
}

}  // namespace shvr
