; BROKEN     Twin of 14b_odds_law.smt2: the second state's likelihood is left out of its posterior.
(set-info :status sat)
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
(assert (= (* qq sum) q))                                      ; BROKEN: no likelihood

; Conclusion, negated
(assert (not (= (* pp m q) (* qq l p))))
(check-sat)
