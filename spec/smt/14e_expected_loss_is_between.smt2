; THEOREM    14e: an expected loss lies between the least and the greatest loss of the action.
; ASSUMED    p1 and p2 are any posterior; low and high bound the losses l1 and l2 of an action.
; CONCLUDED  low <= B <= high. More states go one by one: those behind the first are one state with a
;            loss between theirs.
; SOURCE     S2 E22; spec/decide.md decide.INV-7.
; TWIN       the posterior adds up to less than 1, as the printed one does.
; SOLVERS    z3 cvc5
(set-info :status unsat)
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
(assert (= (+ p1 p2) 1))

; Conclusion, negated
(assert (not (<= low expected high)))
(check-sat)
