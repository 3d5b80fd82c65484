; BROKEN     Twin of 14e_expected_loss_is_between.smt2: the posterior adds up to less than 1, as the printed one does.
(set-info :status sat)
(set-logic QF_NRA)

; Symbols
(declare-const p1 Real)       ; probabilities
(declare-const p2 Real)
(declare-const l1 Real)       ; losses
(declare-const l2 Real)
(declare-const low Real)      ; their bounds
(declare-const high Real)
; Formulas
(define-fun expected () Real (+ (* l1 p1) (* l2 p2)))

; Assumptions
(assert (>= p1 0))
(assert (>= p2 0))
(assert (<= low l1 high))
(assert (<= low l2 high))
(assert (< (+ p1 p2) 1))                                       ; BROKEN: 0.926

; Conclusion, negated
(assert (not (<= low expected high)))
(check-sat)
