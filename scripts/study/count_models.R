# Called by study/with_r.py: count_models.R CELLS.csv OUTPUT.csv. Counts: glmmTMB, Poisson or negative binomial, whichever
# has the lower AIC.
suppressPackageStartupMessages({library(emmeans); library(glmmTMB)})
options(contrasts = c("contr.sum", "contr.poly"))
emm_options(msg.interaction = FALSE)
arguments <- commandArgs(trailingOnly = TRUE)
cells <- read.csv(arguments[1], stringsAsFactors = FALSE, check.names = FALSE)

factors_of <- function(some)
  Filter(function(name) length(unique(some[[name]])) > 1, c("group", "object", "condition"))

formula_of <- function(some, response) {
  used <- factors_of(some)
  within <- setdiff(used, "group")
  random <- c("(1 | participant)", if (length(within) > 1) sprintf("(1 | participant:%s)", within))
  as.formula(paste(response, "~", paste(c(if (length(used)) paste(used, collapse = " * ") else "1", random), collapse = " + ")))
}

with_factors <- function(some) {
  for (name in c("group", "object", "condition", "participant")) some[[name]] <- factor(some[[name]])
  some
}

of_counts <- function(some) {
  some <- with_factors(some)
  some$response <- round(some$value * some$trials)
  formula <- update(formula_of(some, "response"), . ~ . + offset(log(trials)))
  fits <- lapply(list(poisson = poisson, nbinom2 = nbinom2), function(family) tryCatch(
    suppressWarnings(glmmTMB(formula, some, family = family)), error = function(e) NULL))
  known <- Filter(function(fit) !is.null(fit) && is.finite(AIC(fit)) && isTRUE(fit$sdr$pdHess), fits)
  if (!length(known)) return(data.frame())
  best <- names(known)[which.min(sapply(known, AIC))]
  tests <- joint_tests(known[[best]])
  data.frame(effect = gsub(":", " x ", tests[["model term"]]), test = paste("glmmTMB,", best),
             statistic = tests$F.ratio, df = tests$df1, df_error = tests$df2, p = tests$p.value)
}

all <- list()
keys <- c("source", "gravity_g", "condition_of", "measure")
for (some in split(cells, cells[keys], drop = TRUE)) {
  if (!length(factors_of(some)) || length(unique(some$value)) < 2) next
  rows <- tryCatch(of_counts(some), error = function(e) data.frame())
  if (nrow(rows)) all[[length(all) + 1]] <- cbind(some[1, keys], n = length(unique(some$participant)), rows, row.names = NULL)
}
write.csv(do.call(rbind, all), arguments[2], row.names = FALSE)
