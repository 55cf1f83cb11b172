// The fixed parts of the report page and of others that show a body.
#pragma once

namespace palpate {

extern const char* const report_style;     ///< CSS
extern const char* const report_body;      ///< HTML from the canvas to the plots
extern const char* const turnable_script;  ///< JavaScript: a body that can be turned
extern const char* const report_script;    ///< JavaScript: what is drawn, and ...
extern const char* const report_controls;  ///< ... what the user does

}  // namespace palpate
