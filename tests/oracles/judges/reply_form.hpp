// The ways in which a reply can relate to its request.
#pragma once

namespace ex9000::judges {

enum class ReplyForm {
  Wrong,    ///< not a possible reply to the request
  Answer,   ///< the requested data, or a confirmation
  Refusal,  ///< an exception, `?AA`, `?`, or `!` alone: the request has changed nothing
};

}  // namespace ex9000::judges
