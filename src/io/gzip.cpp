#include <coxa/core/error.h>

#include "volume_formats.h"

#include <algorithm>

#define ZLIB_CONST
#include <zlib.h>

namespace coxa::io {
namespace {

// zlib counts in 32 bits: streams are fed and drained in pieces
constexpr std::size_t kPiece = std::size_t{1} << 24;

const Bytef* input(std::string_view bytes) { return reinterpret_cast<const Bytef*>(bytes.data()); }

/// Drains one call's worth of output after `bytes`.
template <class Step>
int drain(z_stream& stream, std::string& out, const Step& step) {
  const std::size_t before = out.size();
  out.resize(before + kPiece);
  stream.next_out = reinterpret_cast<Bytef*>(out.data() + before);
  stream.avail_out = static_cast<uInt>(kPiece);
  const int status = step();
  out.resize(out.size() - stream.avail_out);
  return status;
}

}  // namespace

std::string gzipped(std::string_view bytes) {
  z_stream stream{};
  constexpr int kGzip = 15 + 16;  // window bits, plus 16 for the gzip wrapper (zlib.h)
  COXA_ASSERT(deflateInit2(&stream, 4, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string out;
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    if (stream.avail_in == 0) {
      const std::size_t piece = std::min(kPiece, bytes.size());
      stream.next_in = input(bytes);
      stream.avail_in = static_cast<uInt>(piece);
      bytes.remove_prefix(piece);
    }
    status =
        drain(stream, out, [&] { return deflate(&stream, bytes.empty() ? Z_FINISH : Z_NO_FLUSH); });
    COXA_ASSERT(status == Z_OK || status == Z_STREAM_END || status == Z_BUF_ERROR);
  }
  deflateEnd(&stream);
  return out;
}

std::string inflated(std::string_view bytes, const std::string& source) {
  z_stream stream{};
  constexpr int kEither = 15 + 32;  // window bits, plus 32 to accept gzip and zlib wrappers
  COXA_ASSERT(inflateInit2(&stream, kEither) == Z_OK);
  std::string out;
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    if (stream.avail_in == 0) {
      const std::size_t piece = std::min(kPiece, bytes.size());
      stream.next_in = input(bytes);
      stream.avail_in = static_cast<uInt>(piece);
      bytes.remove_prefix(piece);
    }
    status = drain(stream, out, [&] { return inflate(&stream, Z_NO_FLUSH); });
    const bool starved = stream.avail_in == 0 && bytes.empty();
    if (status != Z_STREAM_END && (status != Z_OK || (starved && stream.avail_out > 0))) {
      inflateEnd(&stream);
      fail(ErrorCode::bad_file, source, ": the compressed data are broken or incomplete");
    }
  }
  inflateEnd(&stream);
  return out;
}

}  // namespace coxa::io
