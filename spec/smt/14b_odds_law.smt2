; THEOREM    14b: an observation multiplies the odds of two states by the ratio of its likelihoods.
; ASSUMED    Two states of a belief, with priors p and q and likelihoods l and m; the weights of all
;            states together are greater than 0.
; CONCLUDED  The posteriors pp = l p/sum and qq = m q/sum are in the ratio l p : m q.
; SOURCE     S2 E13 and E21; spec/decide.md decide.INV-4.
; TWIN       the second state's likelihood is left out of its posterior.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NRA)

; Symbols
(declare-const p Real)        ; prior of one state
(declare-const q Real)        ; prior of another
(declare-const l Real)        ; likelihood in the one
(declare-const m Real)        ; likelihood in the other
(declare-const sum Real)      ; weights of all states
(declare-const pp Real)       ; posterior of the one
(declare-const qq Real)       ; posterior of the other

; Assumptions
(assert (>= p 0))
(assert (>= q 0))
(assert (>= l 0))
(assert (>= m 0))
(assert (> sum 0))
(assert (= (* pp sum) (* l p)))
(assert (= (* qq sum) (* m q)))

; Conclusion, negated
(assert (not (= (* pp m q) (* qq l p))))
(check-sat)
